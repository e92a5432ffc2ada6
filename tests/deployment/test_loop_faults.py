"""What goes wrong in the loop that runs a robot, in simulated time, and how fast everything damps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.deployment.robot import TICK, Robot
from workbench.can import Frame, Setpoint
from workbench.core import SimulationError
from workbench.deployment import Feedback, Host, Target
from workbench.deployment.deploy import run_host
from workbench.rigs import VirtualMotor


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    return Robot(tmp_path).start()


# Actions and observations that are no numbers; a policy that is late.


@pytest.mark.parametrize("spoil", [math.nan, math.inf, -math.inf, 1e9, 60.0])
def test_a_bad_action_damps_in_the_same_tick_and_is_never_sent(robot: Robot, spoil: float) -> None:
    told: list[Setpoint] = []

    def spy(frame: Frame, motor: VirtualMotor, hear: Callable[[Frame], None]) -> None:
        asked = motor.drive.asked(frame)
        if isinstance(asked, Setpoint):
            told.append(asked)
        hear(frame)

    for motor in robot.motors:
        motor.hear = partial(spy, motor=motor, hear=motor.hear)
    robot.controller.spoil = spoil
    robot.run(TICK)
    assert robot.host.state.phase == "damp"
    robot.run(0.02)
    assert told and all(math.isfinite(x) for s in told for x in s)
    assert max(abs(s.torque) for s in told) <= 24.01 and all(robot.damps(k) for k in range(4))


def test_an_observation_that_is_no_number_damps(robot: Robot) -> None:
    robot.host.feedback.position[2] = math.nan
    robot.host._compute()
    assert robot.host.state.phase == "damp"


def test_a_policy_that_is_late_damps(robot: Robot) -> None:
    robot.controller.stuck = robot.network.now()
    damped = robot.until_damped()
    assert 0.036 < damped - robot.controller.stuck <= 0.036 + TICK
    assert robot.host.state.fault == "the policy is late"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ZeroDivisionError("no\nmass"), "ZeroDivisionError: no mass"),
        (SimulationError("the network gives no number"), "the network gives no number"),
    ],
)
def test_a_controller_that_fails_damps_and_says_with_what(robot: Robot, error: Exception, said: str) -> None:
    swings = robot.controller.target

    def fails(*args: object) -> Target:
        raise error

    robot.controller.target = fails
    begin = robot.network.now()
    assert robot.until_damped() - begin <= 2 * TICK
    assert robot.host.state.fault == f"the controller failed: {said}"
    robot.controller.target = swings
    robot.run(0.05)
    assert robot.host.state.fault == f"the controller failed: {said}", "it latches"
    robot.arm()
    assert robot.host.state.phase == "run"


def test_a_controller_that_fails_while_arming_is_not_waited_for(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.host.verify()
    robot.controller.target = lambda *args: math.sqrt(-1.0)
    robot.arm()
    assert robot.host.state.phase == "damp" and "math domain error" in str(robot.host.state.fault)


# The host is gone.


def test_drives_stop_by_themselves_when_the_host_is_gone(robot: Robot) -> None:
    robot.network.sleep_until(robot.network.now() + 0.5)
    for motor in robot.motors:
        assert not motor.enabled and motor.longest <= 0.020 + 2 * robot.network.bank.row
    robot.run(0.1)
    assert robot.host.state.phase == "damp" and not any(motor.enabled for motor in robot.motors)


def test_no_wall_clock_decides_anything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def jumps() -> float:
        jumps.hours = -jumps.hours  # type: ignore[attr-defined]
        return 3600.0 * jumps.hours  # type: ignore[attr-defined]

    jumps.hours = 1  # type: ignore[attr-defined]
    monkeypatch.setattr(time, "time", jumps)
    robot = Robot(tmp_path).start()
    robot.run(0.3)
    assert robot.host.state.phase == "run"


def test_a_loop_that_was_held_up_damps_looks_and_goes_on(robot: Robot) -> None:
    told: list[Setpoint] = []
    hear = robot.motors[0].hear

    def spy(frame: Frame) -> None:
        asked = robot.motors[0].drive.asked(frame)
        if isinstance(asked, Setpoint):
            told.append(asked)
        hear(frame)

    robot.motors[0].hear = spy
    for _ in range(3):
        told.clear()
        robot.network.sleep_until(robot.network.now() + 0.011)
        robot.run(0.03)
        assert abs(told[0].torque) < 0.01 and told[0].kd == pytest.approx(1.0, abs=1e-3), (
            "nothing old is sent"
        )
        assert robot.host.state.phase == "run" and abs(told[-1].torque) > 0.1
    assert robot.host.punctuality.stalls == 3


def test_what_waits_is_read_before_the_loop_judges(robot: Robot) -> None:
    host, network = robot.host, robot.network
    network.sleep_until(network.now() + 0.0025)
    host.drives.send(host._frames)
    network.sleep_until(network.now() + 0.0075)  # held up, with answers in the socket
    assert host.feedback.age(network.now()).min() > 0.009
    host.tick(network.now())
    assert host.state.phase == "run" and host.punctuality.stalls == 0


# The emergency stop.


def test_a_released_emergency_stop_moves_nothing(robot: Robot) -> None:
    robot.host.operator.stop = True
    robot.run(TICK)
    assert robot.host.state.phase == "damp"
    robot.host.operator.stop = False
    robot.run(0.3)
    assert robot.host.state.phase == "damp" and all(robot.damps(k) for k in range(4))
    robot.arm()
    assert robot.host.state.phase == "run"


# Feedback and limits.


def test_limits_hold_for_the_drives_own_loop_too(tmp_path: Path) -> None:
    robot = Robot(tmp_path, pd="drive", kp=40.0, kd=1.0).start()
    robot.run(0.3)
    assert robot.host.state.phase == "run" and robot.setpoint(0).kp == pytest.approx(40.0, abs=0.1)


def test_feedback_starts_unknown(tmp_path: Path) -> None:
    feedback = Feedback(Robot(tmp_path).config)
    assert np.isnan(feedback.position).all() and np.isinf(feedback.age(0.0)).all() and feedback.faulty.all()


def test_a_robot_that_cannot_be_armed_is_not_waited_for(tmp_path: Path) -> None:
    robot = Robot(tmp_path)

    def die(host: Host) -> None:
        robot.motors[1].dead = True

    said = run_host(robot.host, robot.network, 60.0, before=die)
    assert said["fault"] == "no feedback for 9 ms" and said["fault_axes"] == ["left_knee"]
    assert robot.network.now() < 1.0 and not any(motor.enabled for motor in robot.motors)


def test_a_drive_that_reports_a_fault_is_named_with_its_words(tmp_path: Path) -> None:
    robot = Robot(tmp_path)

    def fail(now: float) -> None:
        if now > 0.5 and robot.host.state.phase == "run":
            robot.motors[2].enabled, robot.motors[2].fault = False, 9

    robot.network.every_row = fail
    said = run_host(robot.host, robot.network, 1.0)
    assert said["fault"] == "a drive reports a fault"
    assert said["fault_axes"] == ["right_hip"] and said["fault_words"] == ["under-voltage"]
