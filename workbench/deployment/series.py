"""Series of each axis in a log of frames: commands and feedback by their stamps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from workbench.can import CanConfig, Feedback, FrameError, MotorTable, Setpoint, make_drive
from workbench.can.candump import Logged


@dataclass(frozen=True, eq=False)
class Series:
    """Series of one axis: commands and feedback by stamp, (C,), (C, 5) and (F,), (F, 3)."""

    told_at: np.ndarray
    told: np.ndarray
    said_at: np.ndarray
    said: np.ndarray


def series(config: CanConfig, log: Iterable[Logged]) -> list[Series]:
    """Return commands and feedback of every axis, axis coordinates; frames of no drive are left out."""
    drives = [make_drive(motor, _ranges(motor)) for motor in config.motor]
    on = {bus.name: [i for i, m in enumerate(config.motor) if m.bus == bus.name] for bus in config.bus}
    told: list[list[tuple[float, ...]]] = [[] for _ in drives]
    said: list[list[tuple[float, ...]]] = [[] for _ in drives]
    for stamp, bus, frame in log:
        for index in on.get(bus, []):
            drive, motor = drives[index], config.motor[index]
            asked = drive.asked(frame)
            if isinstance(asked, Setpoint):
                p, v, kp, kd, t = asked
                told[index].append(
                    (stamp, motor.sign * p + motor.offset, motor.sign * v, kp, kd, motor.sign * t)
                )
            try:
                heard = drive.decode(frame)
            except FrameError:
                continue
            if isinstance(heard, Feedback):
                q = motor.sign * heard.position + motor.offset
                said[index].append((stamp, q, motor.sign * heard.velocity, motor.sign * heard.torque))
    out = []
    for commands, answers in zip(told, said, strict=True):
        c, a = np.array(commands).reshape(-1, 6), np.array(answers).reshape(-1, 4)
        out.append(Series(c[:, 0], c[:, 1:], a[:, 0], a[:, 1:]))
    return out


def _ranges(motor: MotorTable) -> tuple[float, float, float] | None:
    r = motor.ranges
    if r.position is None or r.velocity is None or r.torque is None:
        return None
    return r.position, r.velocity, r.torque
