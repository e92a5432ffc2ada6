"""Makes a recording of a log of frames: series per axis on receive stamps, matched to commands."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from workbench.can import CanConfig
from workbench.can.candump import Logged
from workbench.core import Controller, Excitation, InputError, Recording, Timing

from .exchanges import Exchanges, exchanges
from .joints import joints_of
from .limits import limits_of

_FEW = 16  # rows; fewer are no recording
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


def recording(config: CanConfig, log: Iterable[Logged], played: Played) -> Recording:
    """Return the recording of what was played.

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
    made = exchanges(config, log, played.begun, len(played.reference))
    valid = made.complete & _as_played(config, played, made)
    rows = _rows(valid)
    count, gap = rows.stop - rows.start, config.loop.period_s / config.loop.polls
    return Recording(
        name=played.name,
        axes=config.axes,
        coordinates="actuator",
        time=np.arange(count) * gap,
        signals={name: values[rows] for name, values in _signals(config, played, made).items()},
        units=("rad",) * len(config.axes),
        controller=_controller(config),
        excitation=_played_for(count * gap, played.excitation),
        timing=Timing(initial_at_rest=False),
        rig=config.name,
        valid=valid[rows],
    )


def _signals(config: CanConfig, played: Played, made: Exchanges) -> dict[str, np.ndarray]:
    """Signals of a recording, (N, n) each, by all exchanges."""
    polls = config.loop.polls
    signals = {"position": made.position, "velocity": made.velocity, "torque_measured": made.torque}
    if config.loop.pd == "drive":
        signals["position_reference"] = made.setpoints[0]
    else:
        signals["position_reference"] = np.repeat(played.reference, polls, axis=0)
        signals["torque_command"] = made.setpoints[4]
    signals["torque_feedforward"] = np.repeat(played.feedforward, polls, axis=0)
    return signals


def _rows(valid: np.ndarray) -> slice:
    """From the first to the last row that is as it was played.

    Raises:
        InputError: these are too few.
    """
    those = np.flatnonzero(valid)
    rows = slice(int(those[0]), int(those[-1]) + 1) if len(those) else slice(0, 0)
    count = rows.stop - rows.start
    if count < _FEW:
        raise InputError(f"the log has {count} rows of what was played", remedy="was it cut short?")
    return rows


def _played_for(length: float, excitation: Excitation) -> Excitation:
    """An excitation of which some length [s] was played: broken off, nothing in it repeats."""
    wanted = excitation.period_s
    if wanted is not None and length < wanted * (1 - 1e-6):
        return replace(excitation, period_s=None)
    return excitation


def _as_played(config: CanConfig, played: Played, made: Exchanges) -> np.ndarray:
    """Whether each row (N,) was sent what the controller makes of its feedback and of what was played."""
    polls, gains = config.loop.polls, np.array(config.gains())
    stiff, most = config.loop.pd == "drive", limits_of(config).torque
    torque = np.repeat(played.feedforward, polls, axis=0)
    if not stiff and gains.any():
        joints = joints_of(config)
        reference = np.repeat(joints.within(played.reference), polls, axis=0)
        q, w = joints.motion(*made.heard)
        torque = torque + joints.torque(gains[0] * (reference - q) - gains[1] * w, q)
    asked = (*(gains if stiff else np.zeros_like(gains)), np.clip(torque, -most, most))
    # a range that is read from the drive is not known here: nothing is said of its field
    full = [[getattr(m.ranges, name) or np.inf for m in config.motor] for name in ("kp", "kd", "torque")]
    lawful = np.ones(len(made.complete), bool)
    for sent, wanted, scale in zip(made.setpoints[2:], asked, full, strict=True):
        lawful &= (np.abs(sent - wanted) <= _STEPS * np.array(scale)).all(axis=1)
    return lawful


def _controller(config: CanConfig) -> Controller:
    kp, kd = config.gains()
    if not any(kp) and not any(kd):
        return Controller("none", period_s=config.loop.period_s)
    where = "joint" if config.loop.pd == "host" else "actuator"
    return Controller("pd", where, kp=tuple(kp), kd=tuple(kd), period_s=config.loop.period_s)
