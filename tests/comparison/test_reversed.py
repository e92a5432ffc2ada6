"""Torque that pushes the other way is told for each axis on which weight and inertia make it plain."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.planar_leg import MOTION, TORQUE, moved, turned, without, write_leg
from workbench.comparison import reversed_torques, turned_axes
from workbench.core import InputError, Recording
from workbench.diagnosis.checks.sign_check import refuse_wrong_sign_of_torque
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return load_model(str(write_leg(tmp_path_factory.mktemp("leg"))))


def measured(recording: Recording, *axes: str) -> Recording:
    """A log of motion and measured torque alone, which is reversed on some axes."""
    for axis in axes:
        recording = turned(recording, axis, *TORQUE)
    return without(recording, "torque_command", "position_reference")


def test_a_whole_column_that_is_reversed(leg: Model) -> None:
    wrong = measured(moved(), "hip", "knee")
    assert turned_axes(leg, [wrong]) is None
    found = reversed_torques(leg, [wrong])
    assert found is not None and found.whole and found.axes == ("hip", "knee")
    with pytest.raises(InputError, match=r"torque_measured of all axes .* opposite sign"):
        refuse_wrong_sign_of_torque(leg, [wrong])


def test_an_axis_that_neither_sign_explains_hides_no_other(leg: Model) -> None:
    """The knee carries a torque that the model knows nothing of, forty times its own."""
    wrong = measured(moved(), "hip")
    torque = wrong.signals["torque_measured"].copy()
    torque[:, 1] += 40.0 * np.sin(np.arange(len(torque)) / 50.0)
    found = reversed_torques(leg, [replace(wrong, signals={**wrong.signals, "torque_measured": torque})])
    assert found is not None and found.axes == ("hip",) and not found.whole


@pytest.mark.parametrize("friction", [0.0, 0.2, 1.0])
def test_a_sound_log_is_none(leg: Model, friction: float) -> None:
    sound = moved(friction=friction)
    assert reversed_torques(leg, [sound]) is None and reversed_torques(leg, [measured(sound)]) is None


def test_nor_is_a_wrong_mass_or_a_mirror_image(leg: Model, tmp_path: Path) -> None:
    heavy = write_leg(tmp_path)
    heavy.write_text(heavy.read_text().replace('mass="0.7"', 'mass="3.0"'))
    assert reversed_torques(load_model(str(heavy)), [moved()]) is None
    both = measured(turned(turned(moved(), "hip", *MOTION, *TORQUE), "knee", *MOTION, *TORQUE))
    assert reversed_torques(leg, [both]) is None
