"""A base that floats: a right model scores the noise, with force plates and without; what is off is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests import floating_robot
from workbench.comparison import compare, matched, replay_of
from workbench.comparison.floating import with_base
from workbench.core import InputError, Recording
from workbench.effects import compile_plant, load_model
from workbench.models import BASE_AXES, Model
from workbench.recordings import load_recording, save_recording


@pytest.fixture(scope="module")
def robot(tmp_path_factory) -> Model:
    folder = tmp_path_factory.mktemp("robot")
    floating_robot.write_robot(folder)
    return load_model(folder / "robot.toml")


@pytest.mark.parametrize("plates", [True, False])
def test_a_right_model_scores_the_noise_a_heavier_one_does_not(robot: Model, plates: bool) -> None:
    right = compare(robot, [floating_robot.recorded(1.0, seed=1, plates=plates)])
    assert right.consistent and right.error == pytest.approx(right.noise_error, rel=0.05)
    assert right.recordings[0].recording.axes == (*floating_robot.AXES, *BASE_AXES)
    heavier = compare(robot, [floating_robot.recorded(1.0, seed=1, cargo=2.0, plates=plates)])
    assert not heavier.consistent and heavier.error > 1.1 * heavier.noise_error
    off = heavier.recordings[0].position_rmse / heavier.recordings[0].position_noise
    assert off.max() > 1.3


def test_rates_that_were_not_measured_are_those_of_the_pose(robot: Model) -> None:
    whole = floating_robot.recorded(1.0, seed=1)
    rates = {"base_velocity", "base_angular_velocity"}
    result = compare(robot, [replace(whole, extra={k: v for k, v in whole.extra.items() if k not in rates})])
    assert result.error < 1.2 * result.noise_error


def test_without_plates_the_floor_pushes_as_it_does_in_the_run(robot: Model) -> None:
    replay = replay_of(robot, matched(robot, [floating_robot.recorded(1.0, seed=1, plates=False)]))
    motion = replay.motion(compile_plant(robot), 0, replay.run([robot])[0][0])
    lacking = motion.required(robot)[50:, robot.axes.index("base_z")]
    weight = floating_robot.TRUNK + 4 * (floating_robot.HIP + floating_robot.THIGH + floating_robot.SHANK)
    assert abs(lacking.mean()) < 0.05 * 9.81 * weight, "nothing drives the base"


def test_the_pose_goes_through_files(robot: Model, tmp_path) -> None:
    made = floating_robot.recorded(1.0, seed=1)
    save_recording(made, tmp_path / "stand.toml")
    again = load_recording(tmp_path / "stand.toml")
    assert compare(robot, [again]).error == pytest.approx(compare(robot, [made]).error, rel=1e-6)


def test_what_does_not_fit_is_told_in_one_line(robot: Model) -> None:
    made = floating_robot.recorded(1.0, seed=1)

    def other(**extra: np.ndarray | None) -> Recording:
        both = {**made.extra, **extra}
        return replace(made, extra={k: v for k, v in both.items() if v is not None})

    turned = np.tile([np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0], (len(made), 1))
    refused = {
        "no column says where it was; name its columns, or fix the base": other(base_position=None),
        "3 columns instead of 4": other(base_orientation=made.extra["base_position"]),
        "its four numbers have the length 2 in row 1; give unit quaternions": other(
            base_orientation=2.0 * made.extra["base_orientation"]
        ),
        "the base pitches by 90 degrees in row 1": other(base_orientation=turned),
        "6 columns, and model 'robot' has 4 feet": other(ground_force=made.extra["ground_force"][:, :6]),
    }
    for line, recording in refused.items():
        with pytest.raises(InputError, match=line):
            compare(robot, [recording])
    with pytest.raises(InputError, match="has no ground; add a \\[ground\\] table"):
        compare(replace(robot, ground=None), [other(ground_force=None)])
    fixed = replace(robot, floats=False, axes=robot.driven, joints=robot.driven)
    with pytest.raises(InputError, match="the base moves, but that of model 'robot' is fixed"):
        compare(replace(fixed, transmission=np.eye(fixed.size)), [made])


def test_a_quaternion_that_changes_its_sign_is_no_motion(robot: Model) -> None:
    made = floating_robot.recorded(1.0, seed=1)
    flips = np.where(np.arange(len(made)) % 3 == 0, -1.0, 1.0)[:, None]
    pose = {
        name: np.tile(made.extra[name][:1], (len(made), 1)) for name in ("base_position", "base_orientation")
    }
    still = replace(made, extra={**pose, "base_orientation": flips * pose["base_orientation"]})
    assert with_base(still, replace(robot, floats=False)) is still
