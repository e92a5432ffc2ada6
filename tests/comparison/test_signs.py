"""Columns that count the other way are found by weight and inertia, without a command and without a loop."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.planar_leg import MOTION, TORQUE, moved, turned, without, write_leg
from workbench.comparison import Turned, torque_left, turned_axes
from workbench.core import Recording
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return load_model(str(write_leg(tmp_path_factory.mktemp("leg"))))


@pytest.fixture(scope="module")
def sound() -> Recording:
    return moved()


def found(leg: Model, recording: Recording) -> set[tuple[str, bool, bool]]:
    result = turned_axes(leg, [recording])
    assert isinstance(result, Turned)
    return {(turn.axis, turn.motion, turn.torque) for turn in result.turns}


def test_a_right_log_needs_no_turn_whatever_the_friction(leg: Model) -> None:
    for friction in (0.0, 0.2, 1.0):
        assert turned_axes(leg, [moved(friction=friction)]) is None


def test_friction_and_offset_are_no_lack_of_weight(leg: Model) -> None:
    assert (torque_left(leg, [moved(friction=1.0)]) < 0.02).all()


@pytest.mark.parametrize("axis", ["hip", "knee"])
def test_torque_alone(leg: Model, sound: Recording, axis: str) -> None:
    bare = without(turned(sound, axis, *TORQUE), "torque_command", "position_reference")
    assert found(leg, bare) == {(axis, False, True)}


@pytest.mark.parametrize("axis", ["hip", "knee"])
def test_motion_alone(leg: Model, sound: Recording, axis: str) -> None:
    assert found(leg, turned(sound, axis, *MOTION)) == {(axis, True, False)}


@pytest.mark.parametrize("axis", ["hip", "knee"])
def test_a_planar_leg_is_its_own_mirror_image(leg: Model, sound: Recording, axis: str) -> None:
    """Which of the two joints is turned, no motion in the plane tells: both are named."""
    turns = found(leg, turned(sound, axis, *MOTION, *TORQUE))
    assert turns == {("hip", True, True), ("knee", True, True)}
    assert "cannot tell which" in str(turned_axes(leg, [turned(sound, axis, *MOTION, *TORQUE)]))


def test_a_small_axis_counts_as_much_as_a_large_one(leg: Model, sound: Recording) -> None:
    """The knee's torque is a few per cent of the whole power, and all of its own."""
    slow = without(turned(moved(lowest_hz=0.1), "knee", *TORQUE), "torque_command", "position_reference")
    assert found(leg, slow) == {("knee", False, True)}


def test_a_wrong_mass_is_no_sign(leg: Model, sound: Recording, tmp_path: Path) -> None:
    heavy = write_leg(tmp_path)
    heavy.write_text(
        heavy.read_text().replace('mass="0.7"', 'mass="1.6"').replace('mass="1.6"', 'mass="3.0"', 1)
    )
    assert turned_axes(load_model(str(heavy)), [sound]) is None
