"""Parts of a robot do what they are called, and the contact's law is the one that is stated."""

import mujoco
import numpy as np
import pytest

from tests.training.make import machine
from workbench.effects import load_model
from workbench.gait import with_leg_odometry
from workbench.training.contact import EVALUATION, TRAINING
from workbench.training.jump import jump
from workbench.training.legs import machine_limbs
from workbench.training.machine import make_machine
from workbench.training.payload import loaded
from workbench.training.plant import begin
from workbench.training.plants import ClosedChainPlant, TrainedPlant
from workbench.training.robot import IDEAL, PARTS, Robot
from workbench.training.rollout import run

FEET = [f"{leg}_sphere" for leg in ("fl", "fr", "rl", "rr")]


class Still:
    """Whoever asks for the posture."""

    def target(self, since, now):
        return now.machine.posture[None]


def test_training_s_contact_is_as_stiff_as_its_step_allows() -> None:
    m = make_machine("quadruped", load_model("leg"), law=TRAINING).mujoco
    assert m.opt.timestep == TRAINING.step_s and TRAINING.time_constant_s == 2.0 * TRAINING.step_s
    assert (m.geom_solref[[m.geom(foot).id for foot in FEET], 0] == TRAINING.time_constant_s).all()


def test_the_evaluation_s_law_is_laid_in_a_copy() -> None:
    m = machine("quadruped").mujoco
    made = EVALUATION.applied(m, FEET)
    assert made.opt.timestep == 0.0005 and made.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert m.opt.timestep == 0.003 and m.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
    assert "0.5 ms" in str(EVALUATION)


@pytest.mark.parametrize("make", [ClosedChainPlant, TrainedPlant], ids=["hardware", "simulation"])
def test_a_payload_weighs_on_the_feet(make) -> None:
    made = machine("quadruped")
    weights = []
    for payload in (0.0, 4.0):
        plant = make(made, Robot(payload=payload)) if make is ClosedChainPlant else make(made, None, payload)
        log = run(Still(), made, plant, 1.6, 0, command=np.zeros((1, 1)))
        weights.append(np.array(log.rows["ground_force"])[-60:, 2::3].sum(axis=1).mean())
    assert weights[1] - weights[0] == pytest.approx(4.0 * 9.81, rel=0.08)


def test_a_mass_off_the_trunk_s_centre_keeps_the_laws_of_bodies() -> None:
    m = machine("quadruped").mujoco
    made = loaded(m, 4.0)
    trunk = int(m.jnt_bodyid[0])
    assert made.body_mass[trunk] == pytest.approx(m.body_mass[trunk] + 4.0)
    assert made.body_inertia[trunk].sum() == pytest.approx(m.body_inertia[trunk].sum())  # at its own centre


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


def test_parts_of_a_robot_can_stand_up() -> None:
    made = machine("quadruped")
    for name, part in PARTS.items():
        plant = ClosedChainPlant(made, part)
        begin(plant, made)
        plant.advance(np.zeros(12))
        assert np.isfinite(plant.state().position).all(), name


def test_the_jump_leaves_the_ground_and_its_legs_tell_the_speed() -> None:
    """With the foot's radius leg odometry is the trunk's true speed on its feet; as a point it is not."""
    made = machine("quadruped")
    jumped, log = jump(made, TrainedPlant(made, EVALUATION), sensors=None)
    assert jumped.apex > made.height + 0.1 and 1.5 < jumped.take_off < 2.5
    recording = log.recording("jump", made, False).rows(slice(230, 350))  # stretching
    limbs, true = machine_limbs(made), recording.extra["base_velocity"]
    force = recording.extra["ground_force"].reshape(len(recording), 4, 3)
    rows = np.flatnonzero((np.linalg.norm(force, axis=-1) > 20.0).all(axis=1))
    missed = [
        np.abs(with_leg_odometry(limbs, recording, r).extra["base_velocity"] - true)[rows].mean()
        for r in (0.02, 0.0)
    ]
    assert missed[0] < 0.02 and missed[1] > 1.5 * missed[0]
