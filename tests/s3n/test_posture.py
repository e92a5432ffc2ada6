"""The closed chain projected in MuJoCo: Drake agrees, mechanics holds, and what is singular is refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from tests.s3n.postures import NAMES, drake, exact, model, series, states
from workbench.core import InputError, SimulationError
from workbench.effects import load_model
from workbench.s3n import closed_forms, variant_dynamics
from workbench.s3n.posture import PostureDependent
from workbench.s3n.posture_chain import PostureChain
from workbench.s3n.posture_table import tabulate

PART = st.floats(0.0, 1.0)
RATE = st.floats(-8.0, 8.0)


def limited(name: str, low: tuple[float, float], high: tuple[float, float]):
    """The mechanism with other limits."""
    own = model(name)
    assert own.closed_chain is not None
    return replace(own, closed_chain=replace(own.closed_chain, limits=tuple(zip(low, high, strict=True))))


@pytest.mark.parametrize("name", NAMES)
def test_drake_agrees_to_rounding(name: str) -> None:
    q, v = states(name, 8)
    ours, chain, rotor = exact(name).dynamics(q, v), drake(name), np.diag(model(name).actuators.inertia)
    for k, (x, w) in enumerate(zip(q, v, strict=True)):
        real, j = chain.serial_dynamics(x, w), chain.jacobian(x)
        np.testing.assert_allclose(ours.mass[k], real.mass + j.T @ rotor @ j, atol=1e-13)
        thrown = j.T @ rotor @ chain.jacobian_bias(x, w)
        np.testing.assert_allclose(ours.bias[k], real.bias + thrown, atol=1e-11)
        np.testing.assert_allclose(ours.gravity[k], real.gravity, atol=1e-12)
        np.testing.assert_allclose(ours.jacobian[k], j, atol=1e-12)
        np.testing.assert_allclose(ours.drives[k], chain.drive_position(x), atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_series_are_the_chain(name: str) -> None:
    q, v = states(name, 12, seed=1)
    ours, wanted = series(name).dynamics(q, v), exact(name).dynamics(q, v)
    for key in ("mass", "bias", "gravity", "damping", "jacobian", "drives", "potential"):
        value = getattr(wanted, key)
        np.testing.assert_allclose(
            getattr(ours, key), value, atol=2e-8 * np.abs(value).max(), err_msg=key, rtol=0
        )


def test_a_parallelogram_is_the_constant_case() -> None:
    """J is (1, 0), (1, 1), and the rest is the exact variant of the leg."""
    leg = load_model("leg")
    generator = np.random.default_rng(0)
    q = generator.uniform([-1.6, 0.35], [1.6, 2.6], (12, 2))
    v = generator.normal(0.0, 6.0, q.shape)
    found, wanted = PostureChain(leg).dynamics(q, v), variant_dynamics(leg, "exact", q, v)
    np.testing.assert_allclose(found.jacobian, np.tile(closed_forms.JACOBIAN, (12, 1, 1)), atol=1e-13)
    for key in ("mass", "bias", "gravity"):
        np.testing.assert_allclose(getattr(found, key), getattr(wanted, key), atol=1e-11, err_msg=key)
    np.testing.assert_allclose(found.damping, np.tile(wanted.damping, (12, 1, 1)), atol=1e-13)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(NAMES), PART, PART, RATE, RATE)
def test_velocity_terms_do_no_work_of_their_own(name: str, a: float, b: float, v1: float, v2: float) -> None:
    """v (M' v / 2 - bias) = 0, the J' term included."""
    chain, v = series(name), np.array([v1, v2])
    low, high = chain.box.T
    q = low + (0.02 + 0.96 * np.array([a, b])) * (high - low)
    h = 1e-5
    ahead, behind = chain.dynamics(np.stack([q + h * v, q - h * v])).mass
    power = v @ ((ahead - behind) / (2 * h)) @ v / 2
    bias = chain.dynamics(q[None], v[None]).bias[0]
    assert v @ bias == pytest.approx(power, rel=1e-5, abs=1e-6)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(NAMES), PART, PART, RATE, RATE)
def test_virtual_work(name: str, a: float, b: float, t1: float, t2: float) -> None:
    """Power of the drives is power at the joints; J is the slope of the drives' positions, gravity of V."""
    chain, torque = series(name), np.array([t1, t2])
    low, high = chain.box.T
    q = low + (0.02 + 0.96 * np.array([a, b])) * (high - low)
    h = 1e-5
    steps = np.concatenate([q + h * np.eye(2), q - h * np.eye(2)])
    at = chain.dynamics(steps)
    slope = (at.drives[:2] - at.drives[2:]).T / (2 * h)
    here = chain.dynamics(q[None])
    np.testing.assert_allclose(here.jacobian[0], slope, atol=1e-7)
    np.testing.assert_allclose(here.jacobian[0].T @ torque, slope.T @ torque, atol=1e-5)
    np.testing.assert_allclose(here.gravity[0], -(at.potential[:2] - at.potential[2:]) / (2 * h), atol=1e-7)


@pytest.mark.parametrize("name", NAMES)
def test_inertia_is_positive_everywhere(name: str) -> None:
    mass = series(name).dynamics(states(name, 200)[0]).mass
    assert np.linalg.eigvalsh(mass).min() > 0
    np.testing.assert_allclose(mass, mass.transpose(0, 2, 1), rtol=1e-12)


def test_states_are_independent_of_each_other() -> None:
    q, v = states("ankle", 6)
    together, turned = exact("ankle").dynamics(q, v), exact("ankle").dynamics(q[::-1], v[::-1])
    np.testing.assert_allclose(together.bias, turned.bias[::-1], atol=1e-12)


def test_a_posture_outside_the_workspace_is_named() -> None:
    q = np.array([[0.9, -1.6], [0.9, -1.1]])
    with pytest.raises(SimulationError, match=r"'knee_1' of state 1 is at -1.1, outside .* -2 to -1.2"):
        series("five_bar").dynamics(q)
    np.testing.assert_array_equal(series("five_bar").inside(q), [True, False])
    with pytest.raises(SimulationError, match="'drive_1' is at nan"):
        series("five_bar").dynamics(np.array([[np.nan, -1.5]]))


def test_a_loop_that_cannot_close_is_named() -> None:
    with pytest.raises(SimulationError, match=r"five_bar.*cannot be closed at drive_1 = 0.9, knee_1 = 2"):
        exact("five_bar").dynamics(np.array([[0.9, 2.0]]))


def test_the_margin_falls_towards_a_singular_posture() -> None:
    """With the four-bar's coupler and rear arm in line its crank holds still while the knee moves."""
    chain = exact("four_bar")

    def slope(knee: float) -> float:
        try:
            return float(chain.dynamics(np.array([[0.0, knee]])).jacobian[0, 1, 1])
        except SimulationError:  # the root is where it is refused
            return 0.0

    dead = float(brentq(slope, 0.1, 0.4, xtol=1e-12))
    margin = chain.margin(np.array([[0.0, dead + x] for x in (1.0, 0.3, 0.03, 0.003)]))
    assert (np.diff(margin) < 0).all() and margin[-1] < 0.02 * margin[0]
    with pytest.raises(SimulationError, match=rf"dead point \(J is singular\) at hip = 0, knee = {dead:.2f}"):
        chain.dynamics(np.array([[0.0, dead]]))


def test_limits_beyond_the_workspace_are_refused() -> None:
    with pytest.raises(InputError, match=r"closed_chain.limits.*cannot be closed.*within the limits"):
        PostureDependent(limited("five_bar", (0.4, -2.0), (1.4, 2.0)))


def test_limits_with_a_dead_point_inside_are_refused() -> None:
    with pytest.raises(InputError, match=r"passes a dead point of its drives .* knee = 0\.\d+"):
        PostureDependent(limited("four_bar", (-1.6, 0.05), (1.6, 2.5)))


def test_limits_that_touch_a_singular_posture_are_refused() -> None:
    leg = load_model("leg")
    assert leg.closed_chain is not None
    straight = replace(leg.closed_chain, limits=((-1.0, 1.0), (-0.4, 1.0)))
    with pytest.raises(InputError, match=r"limits"):
        PostureDependent(replace(leg, closed_chain=straight))


def test_what_states_no_mechanism_is_refused() -> None:
    with pytest.raises(InputError, match="no closed chain"):
        PostureDependent(load_model("emps"))
    leg = load_model("leg")
    assert leg.closed_chain is not None
    with pytest.raises(InputError, match="no limits"):
        PostureDependent(replace(leg, closed_chain=replace(leg.closed_chain, limits=())))


def test_loops_that_are_not_named_are_refused() -> None:
    own = model("five_bar")
    assert own.closed_chain is not None
    with pytest.raises(InputError, match=r"closed_chain.loops.*names no loops"):
        PostureChain(replace(own, closed_chain=replace(own.closed_chain, loops=())))


def test_a_start_that_does_not_close_is_refused() -> None:
    own = model("five_bar")
    assert own.closed_chain is not None
    wrong = replace(own.closed_chain, start=(("drive_1", 3.0), ("drive_2", -3.0)), limits=())
    with pytest.raises(InputError, match=r"closed_chain.start"):
        PostureChain(replace(own, closed_chain=wrong))


def test_a_series_of_one_angle_and_its_slope() -> None:
    found = tabulate(lambda q: np.exp(q), np.array([[-1.0, 2.0]]), 1e-13)
    assert found is not None
    x = np.linspace(-1.0, 2.0, 7)[:, None]
    np.testing.assert_allclose(found(x), np.exp(x), rtol=1e-11)
    np.testing.assert_allclose(found.slope(0)(x), np.exp(x), rtol=1e-9)
    assert tabulate(lambda q: np.sqrt(q), np.array([[0.0, 1.0]]), 1e-10) is None


def test_a_series_of_three_angles() -> None:
    box = np.array([[-1.0, 0.0], [0.0, 1.0], [0.5, 1.0]])
    found = tabulate(lambda q: np.cos(q @ np.diag([1.0, 2.0, -1.0])).prod(axis=1, keepdims=True), box, 1e-11)
    assert found is not None
    q = np.random.default_rng(0).uniform(*box.T, (20, 3))
    np.testing.assert_allclose(found(q)[:, 0], np.cos(q * [1.0, 2.0, -1.0]).prod(axis=1), atol=1e-9)
    slope = -2.0 * np.sin(2.0 * q[:, 1]) * np.cos(q[:, 0]) * np.cos(q[:, 2])
    np.testing.assert_allclose(found.slope(1)(q)[:, 0], slope, atol=1e-7)
