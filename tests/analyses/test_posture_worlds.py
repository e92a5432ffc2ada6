"""Fields written at every step make a serial tree the closed chain: by state and in motion."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from posture_schedule import Schedule
from posture_worlds import ScheduledWorld

from tests.s3n.postures import NAMES, drake, exact, model, schedule, series, states
from workbench.core import InputError, SimulationError
from workbench.mechanism.simulate import simulate
from workbench.s3n.worlds import World

PERIOD, ROWS = 0.002, 40


def middle(name: str) -> np.ndarray:
    return series(name).box.mean(axis=1)


def swing(name: str) -> np.ndarray:
    """Torques on the drives that hold the middle of the workspace and push to both sides of it, (ROWS, n)."""
    at = exact(name).dynamics(middle(name))
    back = np.linalg.inv(at.jacobian[0]).T
    push = np.random.default_rng(0).choice([-1.0, 1.0], (ROWS // 10, 2)) * 25.0
    return -back @ at.gravity[0] + np.repeat(push, 10, axis=0) @ at.mass[0] @ back.T


def drive_path(name: str) -> np.ndarray:
    """The closed chain in Drake under these torques, drive positions at the end of each row (ROWS, n)."""
    own = model(name)
    start = drake(name).drive_position(middle(name))
    real = simulate(
        drake(name), own.actuators.inertia, own.actuators.damping, swing(name), PERIOD, start, substeps=2
    )
    return real.position[1:]


def run(name: str, world: World) -> np.ndarray:
    steps, path = round(PERIOD / world.m.opt.timestep), []
    for torque in swing(name):
        world.advance(torque, steps)
        path.append(world.state()[0])
    return series(name).dynamics(np.array(path)).drives


@pytest.mark.parametrize("name", NAMES)
def test_every_state_is_exact(name: str) -> None:
    """Mass matrix and acceleration of the scheduled tree are the closed chain's at any state."""
    q, v = states(name, 6)
    torque = np.random.default_rng(3).normal(size=q.shape)
    at = exact(name).dynamics(q, v)
    world = ScheduledWorld(schedule(name), start=(middle(name), np.zeros(2)))
    full = np.zeros((world.m.nv, world.m.nv))
    for k in range(len(q)):
        found = world.acceleration(q[k], v[k], torque[k])
        mujoco.mj_fullM(world.m, world.data, full)
        np.testing.assert_allclose(full, at.mass[k], atol=1e-10)
        force = at.gravity[k] + at.jacobian[k].T @ torque[k] - at.bias[k] - at.damping[k] @ v[k]
        np.testing.assert_allclose(found, np.linalg.solve(at.mass[k], force), rtol=1e-5)


def test_what_is_held_over_a_step_errs_by_its_square() -> None:
    real, off = drive_path("four_bar"), []
    for step in (0.002, 0.001):
        world = ScheduledWorld(schedule("four_bar"), step, "RK4", (middle("four_bar"), np.zeros(2)))
        off.append(float(np.abs(run("four_bar", world) - real).max()))
    assert off[0] < 1e-4 * np.ptp(real, axis=0).max()
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.3)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
def test_integrators_with_one_stage_err_by_their_own_step(integrator: str) -> None:
    real, off = drive_path("five_bar"), []
    for step in (0.001, 0.0005):
        world = ScheduledWorld(schedule("five_bar"), step, integrator, (middle("five_bar"), np.zeros(2)))
        off.append(float(np.abs(run("five_bar", world) - real).max()))
    assert off[0] / off[1] == pytest.approx(2.0, rel=0.1)


def test_energy_is_kept_without_drag() -> None:
    """The four-bar swings freely for half a second; what it has at the end is what it began with."""
    own = model("four_bar")
    free = Schedule(replace(own, actuators=replace(own.actuators, damping=(0.0, 0.0))))
    world = ScheduledWorld(free, 0.0001, "RK4", (np.array([0.5, 1.4]), np.array([-1.0, 0.5])))

    def energy() -> float:
        q, v = world.state()
        at = series("four_bar").dynamics(q)
        return float(v @ at.mass[0] @ v / 2 + at.potential[0])

    before = energy()
    world.advance(np.zeros(2), 3000)
    assert np.abs(world.state()[1]).max() > 1.0
    assert energy() == pytest.approx(before, abs=1e-7)


def test_who_leaves_the_workspace_is_named_or_held() -> None:
    push = np.array([-15.0, 0.0])
    world = ScheduledWorld(schedule("five_bar"), start=(middle("five_bar"), np.zeros(2)))
    with pytest.raises(SimulationError, match=r"t = 0\.\d+ s: .*five_bar.*outside its workspace"):
        world.advance(push, 500)
    held = ScheduledWorld(Schedule(model("five_bar"), beyond="hold"), start=(middle("five_bar"), np.zeros(2)))
    held.advance(push, 60)
    assert not series("five_bar").inside(held.state()[0][None])[0] and np.isfinite(held.state()[0]).all()


def test_a_start_outside_and_an_unknown_integrator_are_refused() -> None:
    with pytest.raises(SimulationError, match="'knee_1' is at 0"):
        ScheduledWorld(schedule("five_bar"), start=(np.array([0.9, 0.0]), np.zeros(2)))
    with pytest.raises(InputError, match="no integrator is called 'best'"):
        ScheduledWorld(schedule("five_bar"), integrator="best")
