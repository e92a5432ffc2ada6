"""Drives that are not what the configuration says."""

from __future__ import annotations

from pathlib import Path

import pytest
from fault_bench import robot as virtual_robot

from tests.deployment.robot import Robot, Swing
from workbench.can import Parameter
from workbench.can.messages import burst
from workbench.deployment import Host, SimulatedNetwork, VerifyError, joints_of

WATCHDOG = Parameter("watchdog", 0.02)


@pytest.mark.parametrize(
    ("parameter", "value", "said"),
    [("mode", 2.0, "is in mode 2"), ("torque", 10.0, "torque range of 10"),
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


@pytest.mark.parametrize("lost", ["nothing", "time", "switch"])
@pytest.mark.parametrize("protocol", ["moteus", "odrive"])
def test_a_watchdog_that_was_told_in_vain_is_refused(tmp_path: Path, protocol: str, lost: str) -> None:
    config = virtual_robot(tmp_path, protocol)
    network = SimulatedNetwork(config)
    host = Host(config, network, Swing(4), joints_of(config))
    send, written = network.send, {"time": host.feedback.drives[0].write(WATCHDOG)}
    if protocol == "odrive":
        time, switch = burst(written["time"])
        written = {"time": time, "switch": switch}
    elif lost == "switch":
        return  # a moteus has none

    network.send = lambda bus, frame: frame == written.get(lost) or send(bus, frame)  # type: ignore[method-assign]
    if lost == "nothing":
        assert [told.told["watchdog"] for told in host.verify()] == pytest.approx([0.02] * 4)
        return
    with pytest.raises(VerifyError, match="the watchdog of 'left_hip' reads 0 ms after 20 ms were written"):
        host.verify()
    assert not any(motor.enabled and motor.longest for motor in network.bank.motors.values())


class Stubborn(dict):
    def __setitem__(self, key: str, value: float) -> None:
        pass


def test_a_silent_drive_is_refused(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.motors[0].dead = True
    with pytest.raises(VerifyError, match="does not answer"):
        robot.host.verify()
