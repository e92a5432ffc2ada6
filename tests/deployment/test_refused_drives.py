"""Drives that are not what the configuration says."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.deployment.robot import Robot
from workbench.deployment import VerifyError


@pytest.mark.parametrize(
    ("parameter", "value", "said"),
    [("mode", 2.0, "is in mode 2"), ("torque", 10.0, "torque range is 10"),
     ("velocity", 30.0, "velocity range")],
)  # fmt: skip
def test_a_drive_that_is_not_as_configured_is_refused(tmp_path, parameter, value, said) -> None:
    robot = Robot(tmp_path)
    robot.motors[2].parameters[parameter] = value
    with pytest.raises(VerifyError, match=said):
        robot.host.verify()
    robot.host.operator.arm = True
    robot.run(0.1)
    assert robot.host.state.phase == "off" and not any(motor.enabled for motor in robot.motors)


def test_a_watchdog_that_cannot_be_set_is_refused(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.motors[1].parameters = Stubborn(robot.motors[1].parameters)
    with pytest.raises(VerifyError, match="watchdog"):
        robot.host.verify()


class Stubborn(dict):
    def __setitem__(self, key: str, value: float) -> None:
        pass


def test_a_silent_drive_is_refused(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.motors[0].dead = True
    with pytest.raises(VerifyError, match="does not answer"):
        robot.host.verify()
