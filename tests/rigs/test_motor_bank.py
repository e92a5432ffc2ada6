"""A bank of virtual drives: what they answer and when, and machines whose drives are off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.can.make import config, motor
from workbench.can import CanConfig, Feedback, Setpoint, make_drive
from workbench.can.messages import burst
from workbench.importing import own_plants
from workbench.rigs import MotorBank

ROW = 0.5e-3
WIDE = {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "a manual"}


def _robot(folder: Path, model: str, axes: tuple[str, ...]) -> CanConfig:
    motors = [motor(axis, k + 1, ranges=WIDE) for k, axis in enumerate(axes)]
    return config(folder, motors, mechanism=[{"model": model, "axes": list(axes)}])


def _bank(robot: CanConfig, own: bool) -> MotorBank:
    return MotorBank(robot, row=ROW, make=own_plants() if own else None)


def _told(robot: CanConfig, bank: MotorBank, said: list, axis: str) -> Feedback:
    drive = make_drive(next(m for m in robot.motor if m.axis == axis))
    [answer] = [heard for name, frame in said if name == axis and (heard := drive.decode(frame))]
    assert isinstance(answer, Feedback)
    return answer


def _ask(robot: CanConfig, bank: MotorBank, torque: float) -> None:
    for m in robot.motor:
        for frame in burst(make_drive(m).command(Setpoint(0.0, 0.0, 0.0, 0.0, torque))):
            bank.motors[m.axis].hear(frame)


def _on(robot: CanConfig, bank: MotorBank) -> None:
    for m in robot.motor:
        bank.motors[m.axis].parameters["watchdog"] = 0.0
        for frame in burst(make_drive(m).act("enable")):
            bank.motors[m.axis].hear(frame)
    bank.work(0.0)


@pytest.mark.parametrize(("model", "own"), [("leg", False), ("four_bar", True)])
def test_an_answer_between_rows_is_that_of_the_next_row(tmp_path: Path, model: str, own: bool) -> None:
    robot = _robot(tmp_path, model, ("hip", "knee"))
    between, in_rows = _bank(robot, own), _bank(robot, own)
    for bank in (between, in_rows):
        _on(robot, bank)
    for k in range(1, 40):
        now, torque = k * ROW, 2.0 * np.sin(k)
        _ask(robot, between, torque)
        early = between.respond(now - 0.3 * ROW)
        between.work(now)
        _ask(robot, in_rows, torque)
        late = in_rows.work(now)
        for axis in robot.axes:
            first, second = (_told(robot, between, said, axis) for said in (early, late))
            # the torque that the answered command asks for, and no command sits in the drive a row longer
            assert first.torque == pytest.approx(torque, abs=0.3)
            assert first.position == pytest.approx(second.position, abs=2e-3)


def test_a_machine_stays_on_its_stand_as_long_as_no_drive_is_on(tmp_path: Path) -> None:
    """An ankle without a drive that is on would fall through its dead point, where its loops cannot close."""
    robot = _robot(tmp_path, "ankle", ("left", "right"))
    bank = _bank(robot, own=True)
    _ask(robot, bank, 0.0)
    start = _told(robot, bank, bank.work(0.0), "left").position
    for k in range(1, 400):
        bank.work(k * ROW)
    _ask(robot, bank, 0.0)
    assert _told(robot, bank, bank.work(400 * ROW), "left").position == pytest.approx(start, abs=2e-3)
    _on(robot, bank)
    for k in range(401, 500):
        bank.work(k * ROW)
    _ask(robot, bank, 0.0)
    assert abs(_told(robot, bank, bank.work(500 * ROW), "left").position - start) > 5e-3
