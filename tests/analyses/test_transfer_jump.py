"""Parts of the study's robots, and its scripted jump with what the legs tell of it."""

import numpy as np
from transfer_filter import with_filtered_velocity
from transfer_jump import jump
from transfer_measures import machine_limbs
from transfer_plants import PARTS
from transfer_robot import RobotPlant
from transfer_worlds import EVALUATION, world_of

from tests.training.make import machine
from workbench.gait import with_leg_odometry
from workbench.training.plant import begin
from workbench.training.plants import TrainedPlant


def test_parts_of_a_robot_can_stand_up() -> None:
    made = machine("quadruped")
    for name, part in PARTS.items():
        plant = RobotPlant(made, part)
        begin(plant, made)
        plant.advance(np.zeros(12))
        assert np.isfinite(plant.state().position).all(), name


def test_the_jump_leaves_the_ground_and_its_legs_tell_the_speed() -> None:
    """With the foot's radius leg odometry is the trunk's true speed on its feet; as a point it is not."""
    made = machine("quadruped")
    jumped, log = jump(made, TrainedPlant(made, world_of(made, EVALUATION, 0.0)), sensors=None)
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


def test_the_filter_follows_the_trunk_where_no_foot_stands() -> None:
    made = machine("quadruped")
    _, log = jump(made, TrainedPlant(made, world_of(made, EVALUATION, 0.0)), sensors=None)
    recording = log.recording("jump", made, False).rows(slice(230, 480))  # stretching, and in the air
    limbs, true = machine_limbs(made), recording.extra["base_velocity"]
    force = np.linalg.norm(recording.extra["ground_force"].reshape(len(recording), 4, 3), axis=-1)
    air = np.flatnonzero((force < 1.0).all(axis=1))
    assert len(air) > 30
    measured = np.diff(true, axis=0, append=true[-1:]) / recording.period
    measured += 0.1 + 0.3 * np.random.default_rng(0).standard_normal(true.shape)
    legs = with_leg_odometry(limbs, recording, 0.02)
    filtered = with_filtered_velocity(limbs, recording, 0.02, measured, 0.3)
    held, followed = (np.abs(r.extra["base_velocity"] - true)[air].mean() for r in (legs, filtered))
    assert followed < 0.1 < 0.5 < held
