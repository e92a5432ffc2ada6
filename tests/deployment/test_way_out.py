"""Every way out of a run: damping at once and for half a second, and then every drive is disabled."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from tests.deployment.robot import TICK, Robot
from workbench.can import Frame, Setpoint
from workbench.deployment.deploy import deploy
from workbench.deployment.drives import CALM
from workbench.deployment.stopping import SIGNALS, RunError, brought_down, exit_code, orphaned
from workbench.rigs import VirtualMotor


class Heard:
    """What each drive heard, and when."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.told = robot, [[] for _ in robot.motors]
        for k, motor in enumerate(robot.motors):
            motor.hear = partial(self._hear, k, motor, motor.hear)

    def now(self) -> float:
        return self.robot.network.now()

    def _hear(self, k: int, motor: VirtualMotor, hear: Callable[[Frame], None], frame: Frame) -> None:
        asked = motor.drive.asked(frame)
        if asked is not None:
            self.told[k].append((self.now(), asked))
        hear(frame)

    def ends_well(self, since: float, within: float = 2 * TICK) -> None:
        """Every drive damps within some time, long enough, and hears as its last that it is off."""
        for motor, told in zip(self.robot.motors, self.told, strict=True):
            after = [(t, s) for t, s in told if t > since]
            first = next(k for k, (_, s) in enumerate(after) if damps(s))
            assert after[first][0] - since <= within, "torque stands no longer than that"
            commands = [s for _, s in after[first:] if isinstance(s, Setpoint)]
            assert all(damps(s) for s in commands), "and nothing else comes after it"
            assert len(commands) >= 0.9 * CALM / TICK
            assert [s for _, s in after[-3:]] == ["disable"] * 3 and not motor.enabled
            assert motor.longest < motor.parameters["watchdog"], "no drive had to stop itself"


def damps(s: object) -> bool:
    return isinstance(s, Setpoint) and s.kp == 0.0 and abs(s.kd - 1.0) < 2e-3 and abs(s.torque) < 0.01


def stopped(by: str | None) -> dict:
    return {"stopped": True, "stopped_by": by, "fault": "emergency stop"}


class Odd(BaseException):
    """Nobody foresaw it."""


def raising(error: BaseException) -> Callable[..., None]:
    def fails(*args: object) -> None:
        raise error

    return fails


def run(robot: Robot, when: float, what: Callable[[], None]) -> float:
    """Runs until some time after it moves, then does something; returns that time."""
    done: list[float] = []

    def each(host, tick) -> bool:
        if host.state.phase == "run" and not done and host.time > when:
            done.append(robot.network.now())
            what()
        return host.state.phase == "damp" or host.operator.stop

    try:
        with brought_down(robot.host):
            robot.host.verify()
            robot.host.operator.arm = True
            robot.host.run(1.0, each)
    finally:
        run.at = done[0] if done else robot.network.now()  # type: ignore[attr-defined]
    return done[0]


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_damps_and_a_second_one_skips_nothing(tmp_path: Path, number: signal.Signals) -> None:
    robot = Robot(tmp_path)
    heard, before = Heard(robot), signal.getsignal(number)

    def twice(now: float) -> None:
        if robot.host.state.phase == "damp":
            os.kill(os.getpid(), number)

    robot.network.every_row = twice
    at = run(robot, 0.6, lambda: os.kill(os.getpid(), number))
    heard.ends_well(at)
    assert robot.host.operator.pressed_by == number.name and exit_code(stopped(number.name)) == 128 + number
    assert signal.getsignal(number) is before


@pytest.mark.parametrize("error", [BrokenPipeError("no terminal"), KeyboardInterrupt(), SystemExit(3), Odd()])
def test_an_exception_of_what_is_called_every_tick(tmp_path: Path, error: BaseException) -> None:
    robot = Robot(tmp_path)
    heard = Heard(robot)
    with pytest.raises(RunError if isinstance(error, Exception) else type(error)):
        run(robot, 0.6, raising(error))
    heard.ends_well(run.at)  # type: ignore[attr-defined]


@pytest.mark.parametrize("error", [RuntimeError("the network"), KeyboardInterrupt(), SystemExit(3), Odd()])
def test_an_exception_of_the_controller(tmp_path: Path, error: BaseException) -> None:
    robot = Robot(tmp_path)
    heard = Heard(robot)

    def spoil() -> None:
        robot.controller.target = raising(error)

    if isinstance(error, Exception):
        run(robot, 0.6, spoil)
    else:
        with pytest.raises(type(error)):
            run(robot, 0.6, spoil)
    heard.ends_well(run.at, 3 * TICK)  # type: ignore[attr-defined]


@pytest.mark.parametrize("part", ["receive", "flush", "ok", "sleep_until", "now"])
def test_an_exception_of_the_network_that_never_goes_away(
    tmp_path: Path, part: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = Robot(tmp_path)
    heard, network, waits = Heard(robot), robot.network, robot.network.sleep_until
    # without its own clock the robot is let down by the machine's
    monkeypatch.setattr("time.sleep", lambda seconds: waits(network._now + seconds))

    def spoil() -> None:
        robot.controller.spoil = float("nan") if part == "flush" else 0.0  # only a fault flushes
        setattr(network, part, raising(OSError("gone")))

    monkeypatch.setattr(Heard, "now", lambda self: network._now)
    with pytest.raises(RunError, match="OSError: gone"):
        run(robot, 0.6, spoil)
    heard.ends_well(run.at, 3 * TICK)  # type: ignore[attr-defined]


def test_one_bus_that_raises_keeps_no_other_from_damping(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    heard, send = Heard(robot), robot.network.send

    def fails(bus: str, frame: Frame) -> bool:
        if bus == "can0":
            raise OSError("cable out")
        return send(bus, frame)

    with pytest.raises(RunError, match="OSError: cable out"):
        run(robot, 0.6, lambda: setattr(robot.network, "send", fails))
    heard.told, robot.motors = heard.told[2:], robot.motors[2:]
    heard.ends_well(run.at, 3 * TICK)  # type: ignore[attr-defined]


def test_the_end_of_a_run_and_a_fault(tmp_path: Path) -> None:
    for fault in (False, True):
        robot = Robot(tmp_path)
        heard = Heard(robot)
        at = run(robot, 0.6, lambda: setattr(robot.controller, "spoil", float("nan")) if fault else None)  # noqa: B023
        heard.ends_well(at if fault else robot.network.now() - CALM - 5 * TICK, 3 * TICK)


def test_a_stop_before_anything_moved_moves_nothing(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.host.operator.watches.append(lambda: "the button")
    with brought_down(robot.host):
        robot.host.verify()
        robot.host.operator.arm = True
        robot.host.run(0.3, lambda host, _: host.operator.stop)
    assert robot.network.now() < 0.1 and not any(motor.longest for motor in robot.motors)


def test_a_run_says_who_stopped_it(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.network.every_row = lambda now: os.kill(os.getpid(), signal.SIGHUP) if 0.4 < now < 0.401 else None
    said = deploy(robot.config, None, 2.0, network=robot.network)
    assert said["fault"] == "emergency stop" and said["stopped"] and said["stopped_by"] == "SIGHUP"
    assert said["ticks"] * TICK < 1.2


def test_a_parent_that_dies_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    watch = orphaned()
    assert watch() is None
    monkeypatch.setattr(os, "getppid", lambda: 1)
    assert watch() == "the end of its parent process" and exit_code(stopped(watch())) == 130
