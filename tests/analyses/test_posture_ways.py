"""The ways of a mechanism that only its study compares: MuJoCo's callback, and many worlds in a batch."""

import mujoco
import numpy as np
import pytest
from posture_batch import ScheduledBatch
from posture_callback import CallbackWorld
from posture_schedule import Schedule
from posture_worlds import ScheduledWorld

from tests.analyses.test_posture_worlds import drive_path, middle, run
from tests.s3n.postures import NAMES, model, schedule, states
from workbench.core import SimulationError


@pytest.mark.parametrize("name", NAMES)
def test_the_callback_follows_the_closed_chain(name: str) -> None:
    """To rounding of the series: it is exact within the stages of RK4 too."""
    ours = run(name, CallbackWorld(schedule(name), 0.001, "RK4", (middle(name), np.zeros(2))))
    real = drive_path(name)
    assert np.ptp(real, axis=0).max() > 0.03
    np.testing.assert_allclose(ours, real, atol=1e-6 * np.ptp(real, axis=0).max())


@pytest.mark.parametrize("hold", [1, 2])
def test_a_batch_is_its_worlds(hold: int) -> None:
    q, v = states("five_bar", 4)
    q, v = 0.3 * (q - middle("five_bar")) + middle("five_bar"), 0.1 * v
    torque = np.random.default_rng(5).normal(size=q.shape)
    batch = ScheduledBatch(schedule("five_bar"), 4, threads=1, hold=hold)
    batch.put(q, v)
    batch.step(torque, 5)
    for k in range(4):
        world = ScheduledWorld(schedule("five_bar"), start=(q[k], v[k]), hold=hold)
        world.advance(torque[k], 5)
        np.testing.assert_allclose(batch.state()[0][k], world.state()[0], atol=1e-12)
        np.testing.assert_allclose(batch.state()[1][k], world.state()[1], atol=1e-10)


def test_drives_differ_from_world_to_world() -> None:
    batch = ScheduledBatch(schedule("ankle"), 3, threads=1)
    batch.put(np.tile(middle("ankle"), (3, 1)), np.zeros((3, 2)))
    batch.inertia[1] *= 4.0
    batch.damping[2] *= 100.0
    batch.step(np.tile([0.5, 0.5], (3, 1)), 20)
    speed = np.abs(batch.state()[1][:, 0])
    assert speed[1] < 0.7 * speed[0] and speed[2] < 0.7 * speed[0]


def test_the_callback_names_who_leaves_and_a_batch_holds_it() -> None:
    push = np.array([-15.0, 0.0])
    callback = CallbackWorld(schedule("five_bar"), start=(middle("five_bar"), np.zeros(2)))
    with pytest.raises(SimulationError, match="outside its workspace"):
        callback.advance(push, 500)
    assert mujoco.get_mjcb_passive() is None
    batch = ScheduledBatch(Schedule(model("five_bar"), beyond="hold"), 2, threads=1)
    batch.put(np.tile(middle("five_bar"), (2, 1)), np.zeros((2, 2)))
    batch.step(np.stack([push, 0.0 * push]), 60)
    np.testing.assert_array_equal(batch.outside, [True, False])
    assert np.isfinite(batch.state()[0]).all()
