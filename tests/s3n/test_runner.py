"""Every variant runs behind one interface; the plain ones do what the closed chain or the simulator does."""

from __future__ import annotations

import numpy as np
import pytest

from tests.s3n.make import HOLD, chirp_torque
from tests.simulation.make import having
from workbench.core import EffectKey, InputError, SimulationError
from workbench.effects import load_model
from workbench.s3n import VARIANT_NAMES, ConstraintSettings, run_variant
from workbench.s3n.worlds import LoopWorld, make_world

START = (HOLD, np.zeros(2))


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    """Motion of the exact variant, integrated finely, (N, 2)."""
    return run_variant(
        load_model("leg"), "exact", chirp_torque(), start=START, step=0.0003, integrator="RK4"
    ).position


@pytest.mark.parametrize("variant", VARIANT_NAMES)
def test_every_variant_runs(variant: str) -> None:
    torque = chirp_torque(30)
    run = run_variant(load_model("leg_kin_only"), variant, torque, start=START)
    assert run.position.shape == run.velocity.shape == run.torque.shape == (30, 2)
    np.testing.assert_allclose(run.position[0], HOLD, atol=1e-9)
    np.testing.assert_array_equal(run.torque, torque)
    assert np.isfinite(run.position).all()
    np.testing.assert_allclose(run.time[1], 0.003)


def test_the_loop_closed_by_constraints_is_near_the_exact_one(exact: np.ndarray) -> None:
    torque = chirp_torque()
    stiff = ConstraintSettings(solref=(0.002, 1.0), solimp=(0.99, 0.999, 0.001, 0.5, 2.0))
    near, soft = (
        run_variant(load_model("leg"), "constraint", torque, start=START, step=0.0003, constraint=settings)
        for settings in (stiff, ConstraintSettings())
    )
    errors = [np.abs(run.position - exact).max() for run in (near, soft)]
    assert errors[0] < 3e-3 and errors[1] > errors[0]
    serial = run_variant(load_model("leg"), "kin_only", torque, start=START, step=0.0003)
    assert np.abs(serial.position - exact).max() > 10 * errors[1]


def test_a_loop_starts_closed_on_its_own_branch() -> None:
    generator = np.random.default_rng(0)
    for _ in range(5):
        q = np.array([generator.uniform(-1.6, 1.6), generator.uniform(0.35, 2.6)])
        world = make_world(load_model("leg"), "constraint", 0.001, start=(q, generator.normal(size=2)))
        assert isinstance(world, LoopWorld)
        assert world.gap() < 1e-9
        position, velocity = world.state()
        np.testing.assert_allclose(position, q, atol=1e-9)
        # the crank of a parallelogram turns with the shank
        crank = world.data.joint("crank_pin")
        np.testing.assert_allclose([crank.qpos[0], crank.qvel[0]], [q.sum(), velocity.sum()], atol=1e-9)


def test_a_law_closes_the_loop() -> None:
    def law(row: int, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        joint = 50.0 * (HOLD + 0.1 - q) - 1.5 * v
        return np.array([joint[0] - joint[1], joint[1]])

    run = run_variant(load_model("leg"), "exact", law, rows=400, start=START)
    assert np.abs(run.position[-1] - HOLD - 0.1).max() < 0.05
    with pytest.raises(InputError, match="rows=N"):
        run_variant(load_model("leg"), "exact", law)


def test_what_does_not_fit_is_refused() -> None:
    leg, torque = load_model("leg"), np.zeros((5, 2))
    for words, change in (
        ("no variant is called 'magic'", {"variant": "magic"}),
        ("no integrator is called 'best'", {"integrator": "best"}),
        ("whole number of steps", {"step": 0.0007}),
        (r"give \(N, 2\)", {"torque": np.zeros((5, 3))}),
    ):
        with pytest.raises(InputError, match=words):
            run_variant(**{"model": leg, "variant": "exact", "torque": torque, **change})
    dry = having(leg, EffectKey("stribeck_friction", "hip"), coulomb=0.1, static=0.2, speed=0.05)
    with pytest.raises(InputError, match="depend on the state"):
        run_variant(dry, "exact", torque)
    with pytest.raises(InputError, match="no closed chain"):
        run_variant(load_model("emps"), "constraint", np.zeros((5, 1)))


def test_a_lost_run_is_named() -> None:
    push = np.tile([1e7, -1e7], (50, 1))
    with pytest.raises(SimulationError, match="unstable at 0"):
        run_variant(load_model("leg"), "exact", push)
    assert np.isnan(run_variant(load_model("leg"), "exact", push, strict=False).position[-1]).all()
