"""From a log of frames to a recording: per-axis series on receive stamps, matched to commands."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from workbench.can import CanConfig, Feedback, FrameError, MotorTable, Setpoint, make_drive
from workbench.can.candump import Logged
from workbench.core import Controller, Excitation, InputError, Recording, Timing

from .joints import joints_of
from .limits import limits_of

_FEW = 16  # rows; fewer are no recording
_EARLY = 0.05  # of an exchange: by which a stamp may lie before its time
_STEPS = 1e-3  # of a field's range: what a frame of twelve bits cannot tell apart


@dataclass(frozen=True, eq=False)
class Played:
    """What the loop played, tick by tick.

    Attributes:
        name: becomes the recording's.
        begun: stamp of the first tick, on the log's clock [s].
        reference, feedforward: (N, n) [rad; N m].
        excitation: its kind.
    """

    name: str
    begun: float
    reference: np.ndarray
    feedforward: np.ndarray
    excitation: Excitation


@dataclass(frozen=True, eq=False)
class Series:
    """What the log says of one axis: commands and feedback by stamp, (C,), (C, 5) and (F,), (F, 3)."""

    told_at: np.ndarray
    told: np.ndarray
    said_at: np.ndarray
    said: np.ndarray


def series(config: CanConfig, log: Iterable[Logged]) -> list[Series]:
    """Commands and feedback of every axis, axis coordinates; what no drive sends or hears is left out."""
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


def recording(config: CanConfig, log: Iterable[Logged], played: Played) -> Recording:
    """The recording of what was played.

    Row m is one exchange. Its position, velocity and torque are the axis's feedback, brought from its own
    receive stamp to the row's time by a spline; its `torque_command` is what was computed from that feedback,
    which went out one tick later. Where an exchange lacks an axis's answer or command the row is masked, and
    so it is where something else was sent than the controller that the recording names: a loop that was held
    up damps, or plays a row late.

    Args:
        config: buses and drives.
        log: frames.
        played: by the loop.

    Raises:
        InputError: hardly anything of what was played is in the log.
    """
    period, polls = config.loop.period_s, config.loop.polls
    gap, ticks = period / polls, len(played.reference)
    every = series(config, log)
    nominal = played.begun + np.arange(ticks * polls) * gap
    late = [_offset(s.said_at, nominal, gap) for s in every]
    if not np.isfinite(late).all():
        axis = config.axes[int(np.flatnonzero(~np.isfinite(late))[0])]
        raise InputError(
            f"the log has no feedback of '{axis}' in what was played", remedy="was it cut short?"
        )
    rows = nominal + np.mean(late)
    n = len(every)
    signals = {name: np.zeros((len(rows), n)) for name in ("position", "velocity", "torque_measured")}
    valid = np.ones(len(rows), bool)
    stiff = config.loop.pd == "drive"
    first = np.arange(len(rows)) // polls * polls  # later exchanges of a tick repeat its command
    setpoints, heard = np.zeros((5, len(rows), n)), np.zeros((2, len(rows), n))
    for axis, (s, offset) in enumerate(zip(every, late, strict=True)):
        found, present = _nearest(s.said_at, nominal + offset, 0.5 * gap)
        valid &= present
        at, values = s.said_at[found[present]], s.said[found[present]]
        for k, name in enumerate(("position", "velocity")):
            signals[name][:, axis] = CubicSpline(at, values[:, k])(np.clip(rows, at[0], at[-1]))
        signals["torque_measured"][:, axis] = np.interp(
            np.arange(len(rows)), np.flatnonzero(present), values[:, 2]
        )
        sent, there = _nearest(s.told_at, nominal + period + _offset(s.told_at, nominal, gap), 0.5 * gap)
        valid &= there[first]
        if len(s.told):
            setpoints[:, :, axis] = s.told[sent[first]].T
            heard[:, :, axis] = s.said[found[first], :2].T
    command = setpoints[0 if stiff else 4]
    valid &= _as_played(config, played, setpoints, heard)
    signals["position_reference"] = np.repeat(played.reference, polls, axis=0)
    if stiff:
        signals["position_reference"] = command
    else:
        signals["torque_command"] = command
    signals["torque_feedforward"] = np.repeat(played.feedforward, polls, axis=0)
    last = int(np.flatnonzero(valid)[-1]) + 1 if valid.any() else 0
    first_row = int(np.flatnonzero(valid)[0]) if valid.any() else 0
    if last - first_row < _FEW:
        raise InputError(
            f"the log has {last - first_row} rows of what was played", remedy="was it cut short?"
        )
    length = (last - first_row) * gap
    excitation, wanted = played.excitation, played.excitation.period_s
    if wanted is not None and length < wanted * (1 - 1e-6):  # broken off: nothing in it repeats
        excitation = replace(excitation, period_s=None)
    return Recording(
        name=played.name,
        axes=config.axes,
        coordinates="actuator",
        time=np.arange(last - first_row) * gap,
        signals={name: values[first_row:last] for name, values in signals.items()},
        units=("rad",) * n,
        controller=_controller(config),
        excitation=excitation,
        timing=Timing(initial_at_rest=False),
        rig=config.name,
        valid=valid[first_row:last],
    )


def _as_played(config: CanConfig, played: Played, setpoints: np.ndarray, heard: np.ndarray) -> np.ndarray:
    """Whether each row (N,) was sent what the controller makes of its feedback and of what was played.

    Args:
        config: gains, limits, transmission.
        played: reference and feedforward by tick.
        setpoints: that went out (5, N, n): position, velocity, kp, kd, torque.
        heard: position and velocity of the feedback (2, N, n).
    """
    polls, gains = config.loop.polls, np.array(config.gains())
    stiff, most = config.loop.pd == "drive", limits_of(config).torque
    torque = np.repeat(played.feedforward, polls, axis=0)
    if not stiff and gains.any():
        joints = joints_of(config)
        reference = np.repeat(joints.within(played.reference), polls, axis=0)
        q, w = (each @ joints.inverse.T for each in heard)
        torque = torque + (gains[0] * (reference - q) - gains[1] * w) @ joints.inverse
    asked = (*(gains if stiff else np.zeros_like(gains)), np.clip(torque, -most, most))
    # a range that is read from the drive is not known here: nothing is said of its field
    full = [[getattr(m.ranges, name) or np.inf for m in config.motor] for name in ("kp", "kd", "torque")]
    lawful = np.ones(setpoints.shape[1], bool)
    for sent, wanted, scale in zip(setpoints[2:], asked, full, strict=True):
        lawful &= (np.abs(sent - wanted) <= _STEPS * np.array(scale)).all(axis=1)
    return lawful


def _controller(config: CanConfig) -> Controller:
    kp, kd = config.gains()
    if not any(kp) and not any(kd):
        return Controller("none", period_s=config.loop.period_s)
    where = "joint" if config.loop.pd == "host" else "actuator"
    return Controller("pd", where, kp=tuple(kp), kd=tuple(kd), period_s=config.loop.period_s)


def _ranges(motor: MotorTable) -> tuple[float, float, float] | None:
    r = motor.ranges
    if r.position is None or r.velocity is None or r.torque is None:
        return None
    return r.position, r.velocity, r.torque


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
