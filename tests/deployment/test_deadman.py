"""A policy that never answers: in simulated time, and beside a thread of the machine's own clock."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest

from tests.deployment.robot import TICK, Robot
from workbench.can import Frame, Setpoint
from workbench.can.clock import Clock
from workbench.deployment.deadman import Deadman
from workbench.deployment.drives import Drives
from workbench.deployment.network import Arrival
from workbench.deployment.safety import damping


def test_a_policy_that_answers_late_damps_and_is_named(tmp_path: Path) -> None:
    robot = Robot(tmp_path).start()
    target, network = robot.controller.target, robot.network

    def slow(*args):
        network.sleep_until(network.now() + 0.037)
        return target(*args)

    robot.controller.target = slow
    begin = network.now()
    assert robot.until_damped() - begin < 0.037 + 3 * TICK
    assert robot.host.state.fault == "the policy is late"


class Wire:
    """A network on the machine's clock that writes down what it is given; its drives say nothing."""

    def __init__(self) -> None:
        self.sent: list[tuple[float, int, Frame]] = []

    def now(self) -> float:
        return time.monotonic()

    def sleep_until(self, time_: float) -> None:
        time.sleep(max(0.0, time_ - time.monotonic()))

    def send(self, bus: str, frame: Frame) -> bool:
        self.sent.append((time.monotonic(), threading.get_ident(), frame))
        return True

    def receive(self, until: float) -> list[Arrival]:
        self.sleep_until(until)
        return []

    def ok(self, bus: str) -> bool:
        return True

    def flush(self, bus: str) -> None: ...

    def restart(self, bus: str) -> None: ...


@pytest.fixture
def drives(tmp_path: Path):
    robot, wire = Robot(tmp_path).start(), Wire()
    config = robot.config
    return Drives(config, wire, robot.host.feedback, 0.009), wire, robot


def test_a_thread_damps_while_a_policy_is_stuck(drives) -> None:
    drives, wire, robot = drives
    frames = drives.encode(damping(robot.host._limits, robot.host.state.position))
    # of a clock so slow that no busy machine makes who answers late
    slow = Clock(30.0).machine
    deadman = Deadman(drives, TICK, 3 * TICK, slow)
    with deadman.watching():
        for _ in range(20):
            with deadman.over(frames):
                pass
        assert not wire.sent, "who answers is left alone"
        begin = time.monotonic()
        with deadman.over(frames):
            while deadman.acted < 3 and time.monotonic() < begin + 60.0:
                time.sleep(0.01)
        count, ended = len(wire.sent), time.monotonic()
        time.sleep(slow(2 * TICK))
        assert len(wire.sent) == count and deadman.acted >= 3
    assert wire.sent[0][0] - begin > slow(3 * TICK) and wire.sent[-1][0] <= ended
    asked = [robot.motors[k % 4].drive.asked(f) for k, (_, _, f) in enumerate(wire.sent)]
    assert all(isinstance(s, Setpoint) and s.kp == 0 and s.kd > 0.9 and abs(s.torque) < 0.01 for s in asked)


def test_a_policy_that_never_answers_ends_with_an_exit_code(drives, capsys) -> None:
    drives, wire, robot = drives
    frames, ended = drives.encode(damping(robot.host._limits, robot.host.state.position)), threading.Event()
    codes: list[int] = []

    def end(code: int) -> None:
        codes.append(code)
        ended.set()

    deadman = Deadman(drives, TICK, 3 * TICK, lambda seconds: seconds, end)
    with deadman.watching(), deadman.over(frames):
        assert ended.wait(60.0)
    asked = [robot.motors[k % 4].drive.asked(f) for k, (_, _, f) in enumerate(wire.sent)]
    assert codes == [1] and asked[-12:] == ["disable"] * 12 and len(asked) > 200
    assert "the policy does not answer" in capsys.readouterr().err
