"""The closed chain in Drake is the paper's leg, and its projection obeys mechanics."""

from pathlib import Path

import numpy as np
import pytest

from workbench.core import Mechanism, SimulationError
from workbench.core.paths import closed_chain_file
from workbench.mechanism import ClosedChain
from workbench.rigs import leg_structure

from .chains import open_loop

STATES = [(np.array([-0.4, 0.7]), np.array([2.0, -3.0])), (np.array([0.9, -0.3]), np.array([-5.0, 8.0]))]


@pytest.fixture(scope="module")
def leg() -> ClosedChain:
    return ClosedChain(closed_chain_file("leg"))


@pytest.fixture(scope="module")
def four_bar(tmp_path_factory: pytest.TempPathFactory) -> ClosedChain:
    """The leg with a longer coupler, which is no parallelogram: its L depends on the posture."""
    text = closed_chain_file("leg").read_text()
    longer = text.replace(
        '<frame name="coupler_end" attached_to="coupler"><pose>0 0 -0.175 0 0 0</pose>',
        '<frame name="coupler_end" attached_to="coupler"><pose>0 0 -0.19 0 0 0</pose>',
    )
    assert longer != text
    file: Path = tmp_path_factory.mktemp("sdf") / "four_bar.sdf"
    file.write_text(longer)
    return ClosedChain(Mechanism(file, start=(("crank_pin", 1.0), ("knee", 1.0), ("coupler_pin", -1.0))))


@pytest.mark.parametrize(("q", "v"), STATES)
def test_the_papers_inertia_and_gravity(leg: ClosedChain, q: np.ndarray, v: np.ndarray) -> None:
    reduced = leg.reduced_dynamics(q, v)
    coupling = 0.005413 * np.cos(q[1] - q[0])
    np.testing.assert_allclose(reduced.mass, [[0.03173, coupling], [coupling, 0.00748]], atol=2e-9)
    np.testing.assert_allclose(
        reduced.gravity, [-1.850411 * np.sin(q[0]), -0.274007 * np.sin(q[1])], atol=5e-7
    )


@pytest.mark.parametrize(("q", "v"), STATES)
def test_closed_form_is_drake(leg: ClosedChain, q: np.ndarray, v: np.ndarray) -> None:
    drake, fast = leg.reduced_dynamics(q, v), leg_structure().reduced_dynamics(q, v)
    np.testing.assert_allclose(fast.mass, drake.mass, atol=1e-12)
    np.testing.assert_allclose(fast.bias, drake.bias, atol=1e-12)
    np.testing.assert_allclose(fast.gravity, drake.gravity, atol=1e-12)


@pytest.mark.parametrize(("q", "_v"), STATES)
def test_the_loop_closes_and_l_is_constant(leg: ClosedChain, q: np.ndarray, _v: np.ndarray) -> None:
    assert open_loop(leg, q) < 1e-14
    np.testing.assert_allclose(leg.projection(q), [[1, 0], [-1, 1], [0, 1], [1, -1]], atol=1e-12)


@pytest.mark.parametrize("name", ["leg", "four_bar"])
@pytest.mark.parametrize(("q", "v"), STATES[:1])
def test_projection_is_the_derivative_of_the_closure(
    name: str, q: np.ndarray, v: np.ndarray, request: pytest.FixtureRequest
) -> None:
    chain: ClosedChain = request.getfixturevalue(name)
    h = 1e-6
    difference = (chain.tree_position(q + h * v) - chain.tree_position(q - h * v)) / (2 * h)
    np.testing.assert_allclose(difference, chain.projection(q) @ v, atol=1e-8)


@pytest.mark.parametrize("name", ["leg", "four_bar"])
@pytest.mark.parametrize(("q", "v"), STATES[:1])
def test_inertia_forces_do_no_work_of_their_own(
    name: str, q: np.ndarray, v: np.ndarray, request: pytest.FixtureRequest
) -> None:
    """Kinetic energy changes only by applied torque: v . bias = v . M' v / 2, the L' term included."""
    chain: ClosedChain = request.getfixturevalue(name)
    h = 1e-5
    ahead, behind = (chain.reduced_dynamics(q + s * h * v, v).mass for s in (1, -1))
    power = 0.5 * v @ ((ahead - behind) / (2 * h)) @ v
    assert v @ chain.reduced_dynamics(q, v).bias == pytest.approx(power, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ["leg", "four_bar"])
def test_gravity_is_the_slope_of_potential_energy(name: str, request: pytest.FixtureRequest) -> None:
    chain: ClosedChain = request.getfixturevalue(name)
    q, h, rest = STATES[0][0], 1e-5, np.zeros(2)
    slope = [(chain.energy(q + h * e, rest) - chain.energy(q - h * e, rest)) / (2 * h) for e in np.eye(2)]
    np.testing.assert_allclose(chain.reduced_dynamics(q, rest).gravity, -np.array(slope), atol=1e-8)


def test_a_payload_is_a_point_mass_on_the_foot() -> None:
    bare, loaded, mass = leg_structure(), leg_structure(0.3), 0.3
    assert loaded.m11 - bare.m11 == pytest.approx(mass * 0.175**2)
    assert loaded.m12 - bare.m12 == pytest.approx(mass * 0.175 * 0.24)
    assert loaded.m22 - bare.m22 == pytest.approx(mass * 0.24**2)
    assert loaded.g1 - bare.g1 == pytest.approx(mass * 9.81 * 0.175)
    assert loaded.g2 - bare.g2 == pytest.approx(mass * 9.81 * 0.24)


def test_a_loop_that_cannot_close_says_where(four_bar: ClosedChain) -> None:
    with pytest.raises(SimulationError, match=r"cannot be closed at hip = 0, crank_pin = 3"):
        four_bar.tree_position(np.array([0.0, 3.0]))


def test_a_dead_point_is_refused(leg: ClosedChain) -> None:
    """With coupler and rear arm in line the motors do not determine the motion of the other two."""
    with pytest.raises(SimulationError, match="dead point"):
        leg.reduced_dynamics(np.array([0.4, 0.4]), np.zeros(2))
