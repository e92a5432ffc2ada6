"""A loop that acts on joints where the file says drives, or the other way round, is named as that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.inspection.belt import BELT, made
from workbench.core import Recording
from workbench.inspection import Remark, inspect
from workbench.inspection.coordinates import law_elsewhere


def stated(recording: Recording, coordinates: str) -> Recording:
    return replace(recording, controller=replace(recording.controller, coordinates=coordinates))


def seen_by(recording: Recording, drives: np.ndarray) -> Recording:
    """The recording with drives that turn as `drives` times the ones it has."""
    motion, torque = drives.T, np.linalg.inv(drives)
    return recording.with_signals(
        **{name: recording.signals[name] @ motion for name in ("position", "velocity")},
        **{
            name: recording.signals[name] @ torque
            for name in ("torque_command", "torque_measured", "torque_feedforward")
        },
    )


def told(recording: Recording) -> list[Remark]:
    return [r for r in inspect([recording]).recordings[0].remarks if "other coordinates" in r.text]


def test_a_law_of_the_joints_said_to_be_one_of_the_drives() -> None:
    (remark,) = told(stated(made(), "actuator"))
    assert remark.severity == "problem" and remark.value["coordinates"] == "joint"
    assert 'State coordinates = "joint"' in remark.text and remark.value["unexplained"] < 0.005
    assert told(made()) == []


@pytest.mark.parametrize("drives", [np.array([[2.0, 0.0], [0.0, 1.0]]), np.array([[1.0, 0.5], [-0.5, 1.0]])])
def test_any_constant_transmission_shows_in_the_command_itself(drives: np.ndarray) -> None:
    """No model is at hand, and the transmission is none of the usual ones."""
    (remark,) = told(stated(seen_by(made(), drives), "actuator"))
    np.testing.assert_allclose(remark.value["to_controller"], np.linalg.inv(drives @ BELT), atol=0.02)


def test_a_law_of_the_drives_said_to_be_one_of_the_joints() -> None:
    r = made()
    kp, kd = np.array([30.0, 20.0]), np.array([0.9, 0.7])
    held = np.repeat(np.arange(0, len(r), 3), 3)[: len(r)]
    goal = r.signals["position_reference"] @ BELT.T
    command = (kp * (goal - r.position) - kd * r.velocity)[held] + r.signals["torque_feedforward"][held]
    own = r.with_signals(torque_command=command, position_reference=goal)
    found = law_elsewhere(stated(own, "joint"), BELT)
    assert found is not None and found.coordinates == "actuator"
    assert law_elsewhere(stated(own, "actuator"), BELT) is None


def test_the_models_transmission_is_asked_where_there_is_one() -> None:
    found = law_elsewhere(stated(made(), "actuator"), BELT)
    assert found is not None and found.coordinates == "joint"
    assert law_elsewhere(made(), BELT) is None
    assert law_elsewhere(stated(made(), "actuator"), np.eye(2)) is None


def test_wrong_gains_are_no_other_coordinates() -> None:
    r = made()
    wrong = replace(r, controller=replace(r.controller, kp=(15.0, 40.0)))
    assert told(wrong) == []
