"""Drake's discrete simulation is the projected one as far as its step allows, and stands on a ground."""

import numpy as np
import pytest

from workbench.core import InputError
from workbench.mechanism import DiscreteChain, Ground, simulate

from .chains import LEGS, NAMES, chain, joints_at, mechanism, quadruped, simulate_discrete

INERTIA, DAMPING, STEP = (0.0162, 0.0162), (0.0972, 0.0972), 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_the_difference_halves_with_the_step(name: str) -> None:
    q0 = chain(name).drive_position(joints_at(name, (0.5, 0.5)))
    time = STEP * np.arange(200)
    torque = 0.3 * np.column_stack([np.sin(20 * time), np.sin(27 * time)])
    exact = simulate(chain(name), INERTIA, DAMPING, torque, STEP, q0)
    found = [
        simulate_discrete(mechanism(name), INERTIA, DAMPING, torque, STEP, q0, substeps=k) for k in (1, 2)
    ]
    coarse, fine = (np.abs(motion.position - exact.position).max() for motion in found)
    assert coarse < 1e-3
    assert fine < 0.55 * coarse


def test_loops_stay_closed_within_micrometres() -> None:
    leg = DiscreteChain(mechanism("leg"), INERTIA, DAMPING, STEP)
    gaps = []
    for _ in range(200):
        leg.advance(np.array([1.5, -0.8]))
        gaps.append(leg.loop_gap)
    assert 0.0 < max(gaps) < 1e-5


def test_a_quadruped_stands() -> None:
    """The ground carries its weight, 8 kg and four legs of 2.13 kg."""
    ground = Ground(feet=tuple(f"{leg}_foot" for leg in LEGS))
    robot = DiscreteChain(quadruped(), [0.0162] * 8, [0.0972] * 8, STEP, ground)
    wanted = np.tile([-0.55, -0.55 + np.pi / 3], 4)
    height = 0.02 + 0.175 * np.cos(wanted[0]) + 0.24 * np.cos(wanted[1])
    robot.reset(wanted, base=np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, height]))
    forces = []
    for _ in range(500):
        robot.advance(150.0 * (wanted - robot.position) - 8.0 * robot.velocity)
        forces.append(robot.ground_force.sum(axis=0))
    np.testing.assert_allclose(np.mean(forces[-200:], axis=0), [0, 0, (8 + 4 * 2.13) * 9.81], atol=2.0)
    assert robot.ground_force[:, 2].min() > 10.0
    assert robot.base[6] == pytest.approx(height, abs=0.02)
    assert robot.loop_gap < 1e-5


def test_a_base_that_is_held_has_no_pose() -> None:
    leg = DiscreteChain(mechanism("leg"), INERTIA, DAMPING, STEP)
    with pytest.raises(InputError, match="the base is held; give a ground"):
        leg.reset(np.zeros(2), base=np.zeros(7))
