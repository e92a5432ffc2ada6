"""What is sent to the drives, as a function of the state, the measurements and the commands.

No input or output, no clock, no memory but the state that is handed in and given back: every sentence about
it can be tried. Phases: off; arm (a setpoint where the axis is, no stiffness); soft_start; run; damp (no
torque, no stiffness, damping). A fault latches in damp until someone arms again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from .frozen import Watch, base_frozen, frozen, let_go, unwatched, watch
from .limits import Limits
from .seen import Seen, Setpoints, Wanted

#: What is wrong, and with which axes by number; nothing where it is None.
Problem = tuple[str | None, tuple[int, ...]]
Phase = Literal["off", "arm", "soft_start", "run", "damp"]
_CARRIED = 0.3  # of its weight: less holds no robot up, with all that its legs pull at it
_HUGE = 10.0  # times the limit: no controller that works asks for this


@dataclass(frozen=True, eq=False)
class SafetyState:
    """State of safety between ticks.

    Attributes:
        phase: see the module.
        since: when it began [s].
        fault: why it damps; None for no fault.
        asked: whether arming was asked for at the last tick: only asking anew arms.
        time: of the last tick [s].
        position: last position that was a number (n,) [rad].
        torque: last torque that went out, a drive's own stiffness included (n,) [N m].
        told: the same, at least and at most, by what a drive's own damping may add to it (2, n) [N m].
        watch: over words that do not change.
        axes: whom the fault is of, by number; empty where it is of nobody.
    """

    phase: Phase
    since: float
    fault: str | None
    asked: bool
    time: float
    position: np.ndarray
    torque: np.ndarray
    told: np.ndarray
    watch: Watch
    axes: tuple[int, ...] = ()


def initial(n: int) -> SafetyState:
    """Return the state off, with nothing known of n axes."""
    return SafetyState("off", 0.0, None, False, 0.0, np.zeros(n), np.zeros(n), np.zeros((2, n)), unwatched(n))


def step(
    limits: Limits, state: SafetyState, seen: Seen, wanted: Wanted | None
) -> tuple[SafetyState, Setpoints]:
    """Return the next state and the setpoints, for one tick.

    Whatever comes in, what goes out is finite, within position, velocity and gain limits, and its torque
    (stiffness included) within the torque limit.

    Args:
        limits: of every axis.
        state: after the last tick.
        seen: now.
        wanted: None where no controller has spoken.

    Returns:
        The state after this tick, and what goes out.
    """
    position = np.where(np.isfinite(seen.position), seen.position, state.position)
    moving = state.phase in ("soft_start", "run")
    state = replace(state, watch=watch(limits, state.watch, seen, state.told, moving))
    moved = _phase(limits, state, seen, wanted)
    if moved.phase in ("soft_start", "run") and wanted is not None:
        fade = 1.0 if moved.phase == "run" else (seen.now - moved.since) / limits.soft_start_s
        elapsed = min(max(seen.now - state.time, 0.0), limits.stale_s)
        out = _limited(limits, wanted.setpoints, position, state.torque, elapsed, min(max(fade, 0.0), 1.0))
    else:
        out = damping(limits, position, off=moved.phase == "off")
    torque = out.torque + out.kp * (out.position - position)
    doubt = out.kd * np.abs(out.velocity - np.nan_to_num(seen.velocity))
    told = np.array([torque - doubt, torque + doubt])
    return replace(moved, time=seen.now, position=position, torque=torque, told=told, asked=seen.arm), out


def _phase(limits: Limits, state: SafetyState, seen: Seen, wanted: Wanted | None) -> SafetyState:
    """The phase of this tick."""

    def to(phase: Phase, problem: Problem = (None, ())) -> SafetyState:
        return replace(state, phase=phase, since=seen.now, fault=problem[0], axes=problem[1])

    problem = _sight(limits, state, seen)
    if state.phase in ("off", "damp"):
        anew = seen.arm and not state.asked
        if anew and problem is None and seen.verified:
            return to("arm")
        return replace(state, fault=problem[0], axes=problem[1]) if anew and problem else state
    if problem is None and (seen.failed or wanted or state.phase != "arm"):
        problem = (seen.failed or _wish(limits, wanted), ())
    if problem is not None and problem[0] is not None:
        return to("damp", problem)
    if not seen.arm:
        return to("damp")
    if state.phase == "arm":
        return to("soft_start" if limits.soft_start_s > 0 else "run") if wanted is not None else state
    if state.phase == "soft_start" and seen.now - state.since >= limits.soft_start_s:
        return to("run")
    return state


def _sight(limits: Limits, state: SafetyState, seen: Seen) -> Problem | None:
    """What is wrong with what is seen, and of which axes."""
    for whole, said in ((seen.stop, "emergency stop"), (not seen.bus_ok, "bus off or queue full")):
        if whole:
            return said, ()
    moving = state.phase in ("soft_start", "run")
    over, lost = limits.overrun, f"{1e3 * limits.stale_s:.3g} ms"
    tilt = _tilt(seen.gravity)
    checks: tuple[tuple[np.ndarray | bool, str], ...] = (
        (~(seen.age < limits.stale_s), f"no feedback for {lost}"),
        (~np.isfinite(seen.position) | ~np.isfinite(seen.velocity), "feedback is not a number"),
        (not seen.base_age < limits.stale_s, f"no data of the base for {lost}"),
        (seen.faulty, "a drive reports a fault"),
        (not seen.gap <= limits.watchdog_s, "the time between commands was longer than a drive's watchdog"),
        (
            tilt > limits.tilt,
            f"tilted by {np.degrees(tilt):.0f} degrees, beyond {np.degrees(limits.tilt):.0f}",
        ),
        (seen.carried < _CARRIED, "falls freely"),
        ((seen.position < limits.low - over) | (seen.position > limits.high + over), "position limit"),
        (np.abs(seen.velocity) > limits.velocity, "velocity limit"),
        (seen.temperature > limits.temperature, "temperature limit"),
        (frozen(limits, state.watch, seen), "feedback is frozen"),
        (moving & let_go(state.watch, seen), "a drive does not follow its torque"),
        (base_frozen(seen), "the inertial unit is frozen"),
    )
    for wrong, said in checks:
        if np.any(wrong):
            return said, tuple(np.flatnonzero(wrong).tolist()) if np.ndim(wrong) else ()
    return None


def _tilt(gravity: np.ndarray) -> float:
    """Angle between the base's downward axis and gravity (3,) [rad]; NaN where it is not known."""
    length = float(np.linalg.norm(gravity))
    return float(np.arccos(np.clip(-gravity[2] / length, -1.0, 1.0))) if length > 0.0 else np.nan


def _wish(limits: Limits, wanted: Wanted | None) -> str | None:
    """What is wrong with what is wanted."""
    if wanted is None or not wanted.age <= limits.late_s:
        return "the policy is late"
    s = wanted.setpoints
    if not np.isfinite([*s.position, *s.velocity, *s.kp, *s.kd, *s.torque]).all():
        return "an action is not a number"
    middle, half = 0.5 * (limits.low + limits.high), 0.5 * (limits.high - limits.low)
    far = (np.abs(s.position - middle) > _HUGE * half) & (s.kp > 0.0)
    if far.any() or (np.abs(s.torque) > _HUGE * limits.torque).any():
        return "an action is huge"
    return None


def _limited(
    limits: Limits, s: Setpoints, q: np.ndarray, last: np.ndarray, elapsed: float, fade: float
) -> Setpoints:
    """Setpoints (all finite) within limits: `fade` of the torque, at its rate from `last` (n,)."""
    kp, kd = np.clip(fade * s.kp, 0.0, limits.kp), np.clip(s.kd, 0.0, limits.kd)
    position = np.clip(s.position, limits.low, limits.high)
    torque = np.clip(fade * s.torque, -limits.torque, limits.torque)
    room = limits.torque_rate * elapsed
    low, high = np.maximum(-limits.torque, last - room), np.minimum(limits.torque, last + room)
    # beyond a position limit only torque that leads back, at once
    low_side, high_side = np.where(q <= limits.low, 0.0, -np.inf), np.where(q >= limits.high, 0.0, np.inf)
    low, high = np.clip(low, low_side, high_side), np.clip(high, low_side, high_side)
    total = np.clip(torque + kp * (position - q), low, high)
    stiff = kp > 0.0
    torque = np.where(stiff, np.clip(torque, low, high), total)
    spring = np.divide(total - torque, kp, out=np.zeros_like(kp), where=stiff)
    position = np.clip(np.where(stiff, q + spring, q), limits.low, limits.high)
    # outside its limits an axis is drawn back no harder than its torque limit allows
    reach = np.divide(limits.torque - np.abs(torque), kp, out=np.full_like(kp, np.inf), where=stiff)
    weak = np.minimum(1.0, np.divide(reach, np.abs(position - q), out=np.ones_like(kp), where=position != q))
    velocity = np.clip(s.velocity, -limits.velocity, limits.velocity)
    return Setpoints(position, velocity, np.where(stiff, kp * weak, 0.0), kd, torque)


def damping(limits: Limits, q: np.ndarray, off: bool = False) -> Setpoints:
    """Return setpoints of damping alone at positions q (n,) [rad], or of nothing if `off`."""
    zero = np.zeros_like(q)
    kd = zero if off else np.minimum(limits.damping, limits.kd)
    return Setpoints(np.clip(q, limits.low, limits.high), zero, zero, kd, zero)
