"""Parts of the study's robot do what they are called, and its ground damps as it is stated."""

import numpy as np
import pytest
from transfer_robot import IDEAL, Robot, RobotPlant

from tests.training.make import machine
from workbench.training.rollout import run


class Still:
    """Whoever asks for the posture."""

    def target(self, since, now):
        return now.machine.posture[None]


def test_a_ground_s_damping_is_the_stated_one() -> None:
    """What Drake takes by itself, a tenth of a second of the stiffness, hits a foot that lands harder."""
    made, landed = machine("quadruped"), []
    for damping in (20.0, None):
        plant = RobotPlant(made, Robot(ground_stiffness=2e4, ground_damping=damping))
        log = run(Still(), made, plant, 0.1, 0, command=np.zeros((1, 1)))
        force = np.array(log.rows["ground_force"])[10:60, 2::3].sum(axis=1)
        landed.append(np.abs(np.diff(force)).sum())
    assert landed[1] > 1.5 * landed[0]


def test_drives_lose_torque_with_speed_and_with_the_battery() -> None:
    limit, torque = np.full(2, 24.0), np.array([20.0, 20.0])
    assert IDEAL.delivered(torque, np.array([30.0, 30.0]), limit).tolist() == [20.0, 20.0]
    fast = Robot(no_load_speed=25.0)
    assert fast.delivered(torque, np.array([20.0, 0.0]), limit) == pytest.approx([9.6, 20.0])
    assert fast.delivered(-torque, np.array([20.0, 0.0]), limit) == pytest.approx([-20.0, -20.0])  # it brakes
    tired = Robot(no_load_speed=25.0, sag=0.5)
    assert tired.delivered(torque, np.array([20.0, 20.0]), limit)[0] < 9.6


def test_an_inertial_unit_is_late_and_leans() -> None:
    down, still = np.array([[0.0, 0.0, -1.0]]), np.zeros((1, 3))
    before = [(down, np.full((1, 3), float(k))) for k in (1, 2, 3)]
    robot = Robot(imu_steps=2, gyro_bias=(0.1, 0.0, 0.0), tilt_bias=(0.0, 0.02))
    gravity, angular = robot.felt(down, still, before)
    assert gravity[0] == pytest.approx([-0.02, 0.0, -1.0]) and angular[0] == pytest.approx([2.1, 2.0, 2.0])
    assert IDEAL.felt(down, still, before)[1].tolist() == still.tolist()
