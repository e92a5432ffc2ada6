"""The exchanges of a loop with its drives, by a log of frames: at even steps, all axes side by side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from workbench.can import CanConfig, Feedback, FrameError, MotorTable, Setpoint, make_drive
from workbench.can.candump import Logged
from workbench.core import InputError

_EARLY = 0.05  # of an exchange: by which a stamp may lie before its time


@dataclass(frozen=True, eq=False)
class Exchanges:
    """Answers and commands of drives, one row per exchange, (N, n); for a single axis (N,).

    Attributes:
        position, velocity, torque: the feedback, brought from its receive stamps to the rows' times.
        setpoints: that went out one tick later: position, velocity, kp, kd, torque, (5, N, n).
        heard: position and velocity of the feedback as it came, that these were computed from, (2, N, n).
        complete: whether no axis lacks its answer or command, (N,).
    """

    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    setpoints: np.ndarray
    heard: np.ndarray
    complete: np.ndarray


def exchanges(config: CanConfig, log: Iterable[Logged], begun: float, ticks: int) -> Exchanges:
    """Return the exchanges of some ticks of a loop.

    Args:
        config: buses and drives.
        log: frames.
        begun: stamp of the first tick, on the log's clock [s].
        ticks: their number.

    Raises:
        InputError: an axis has no feedback there.
    """
    period, polls = config.loop.period_s, config.loop.polls
    gap = period / polls
    every = series(config, log)
    nominal = begun + np.arange(ticks * polls) * gap
    late = [_offset(s.said_at, nominal, gap) for s in every]
    if not np.isfinite(late).all():
        axis = config.axes[int(np.flatnonzero(~np.isfinite(late))[0])]
        raise InputError(
            f"the log has no feedback of '{axis}' in what was played", remedy="the log may be cut short"
        )
    rows = nominal + np.mean(late)
    return _side_by_side(
        [_of_axis(s, nominal, offset, rows, period, polls) for s, offset in zip(every, late, strict=True)]
    )


def _of_axis(
    own: Series, nominal: np.ndarray, late: float, rows: np.ndarray, period: float, polls: int
) -> Exchanges:
    """The exchanges of one axis.

    Args:
        own: its commands and feedback.
        nominal: times of the exchanges (N,) [s].
        late: by how much its feedback lies behind these [s].
        rows: times to which feedback is brought (N,) [s].
        period: of the loop [s].
        polls: exchanges in each.
    """
    gap = period / polls
    found, present = _nearest(own.said_at, nominal + late, 0.5 * gap)
    at, values = own.said_at[found[present]], own.said[found[present]]
    inside = np.clip(rows, at[0], at[-1])
    answered = nominal + period + _offset(own.told_at, nominal, gap)
    sent, there = _nearest(own.told_at, answered, 0.5 * gap)
    first = np.arange(len(rows)) // polls * polls  # later exchanges of a tick repeat its command
    told = len(own.told) > 0
    return Exchanges(
        position=CubicSpline(at, values[:, 0])(inside),
        velocity=CubicSpline(at, values[:, 1])(inside),
        torque=np.interp(np.arange(len(rows)), np.flatnonzero(present), values[:, 2]),
        setpoints=np.take(own.told.T, sent[first], axis=1) if told else np.zeros((5, len(rows))),
        heard=np.take(own.said.T[:2], found[first], axis=1) if told else np.zeros((2, len(rows))),
        complete=present & there[first],
    )


def _side_by_side(axes: Sequence[Exchanges]) -> Exchanges:
    names = ("position", "velocity", "torque", "setpoints", "heard")
    signals = {name: np.stack([getattr(each, name) for each in axes], axis=-1) for name in names}
    return Exchanges(**signals, complete=np.logical_and.reduce([each.complete for each in axes]))


def _offset(stamps: np.ndarray, nominal: np.ndarray, gap: float) -> float:
    """By how much stamps (F,) lie behind the nominal times (N,) of their exchanges: median [s], or NaN."""
    inside = stamps[(stamps >= nominal[0] - _EARLY * gap) & (stamps < nominal[-1] + gap)]
    if not len(inside):
        return float("nan")
    # a stamp at the very time of its exchange must not count as one at the end of the one before
    return float(np.median((inside - nominal[0] + _EARLY * gap) % gap)) - _EARLY * gap


def _nearest(stamps: np.ndarray, wanted: np.ndarray, most: float) -> tuple[np.ndarray, np.ndarray]:
    """Index (N,) of the stamp (F,) nearest to each wanted time (N,), and whether it is within `most` [s]."""
    if not len(stamps):
        return np.zeros(len(wanted), int), np.zeros(len(wanted), bool)
    right = np.clip(np.searchsorted(stamps, wanted), 0, len(stamps) - 1)
    left = np.maximum(right - 1, 0)
    index = np.where(np.abs(stamps[left] - wanted) <= np.abs(stamps[right] - wanted), left, right)
    return index, np.abs(stamps[index] - wanted) <= most


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
