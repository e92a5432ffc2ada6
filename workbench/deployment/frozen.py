"""Feedback that contradicts itself or the commands: drives that repeat themselves, or do nothing.

A drive at rest says the same bytes for as long as it rests: steps of position, speed, torque and temperature
swallow all noise. So sameness alone is no fault. It is one where the words contradict themselves or what the
drive was told, for longer than some ticks:

* A drive reports the torque that it makes, in every protocol here. If the torque that it is told changes by a
  twentieth of its limit and the report does not change by one step (nor do position and speed), the report is
  not of now. This holds at rest and against a hard stop. A drive that is short of torque reports its most
  while it is told still more; what it is told beyond its own report is therefore not counted, but for a
  quarter of its limit, which every drive that works must be able to follow.
* A reported speed that is not zero moves the position. If both stay the same while the speed would have moved
  the axis by more than any step or play of an encoder, the report is not of now.

A drive that has let go without a word (its watchdog, a fault that its protocol does not carry) shows in the
same report: for a tenth of a second it makes less than a quarter of the torque that it is told.

What these cannot see is a drive that freezes at rest, with nothing new to do: until it is told something
else, nothing tells it from one that rests. It would take a counter in its frames, or torque for no other
reason.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .limits import Limits
from .seen import Seen

_FOLLOWS = 0.25  # of the torque limit, which a drive that works can make
_LITTLE, _LET_GO_S = 0.25, 0.1  # of the torque that is told, and for how long [s]
_TURNS, _MOVED = 0.1, 0.02  # rad/s, rad: above steps and offsets of a speed at rest, and of encoders
BASE_S, _MOVES = 0.1, 0.5  # s without a new word of an inertial unit, while a joint is this fast [rad/s]


@dataclass(frozen=True, eq=False)
class Watch:
    """State of the check of each drive; arrays (n,) and (3, n).

    Attributes:
        words: last position, velocity and torque.
        since: since when they have been the same [s].
        low, high: of the torques that it was told since, and had the time to follow [N m].
        obeyed: when it last made some of the torque that it was told [s].
        told: least and most of the last tick but one (2, n); younger ones may still be on their way.
    """

    words: np.ndarray
    since: np.ndarray
    low: np.ndarray
    high: np.ndarray
    obeyed: np.ndarray
    told: np.ndarray


def unwatched(n: int) -> Watch:
    """Return the initial state for n drives."""
    zero = np.zeros(n)
    return Watch(
        np.full((3, n), np.nan), zero, np.full(n, np.inf), np.full(n, -np.inf), zero, np.zeros((2, n))
    )


def watch(limits: Limits, before: Watch, seen: Seen, last: np.ndarray, moving: bool) -> Watch:
    """Return the state after one tick.

    Args:
        limits: of every axis.
        before: after the last tick.
        seen: now.
        last: torque that the last tick computed, which is being sent now, at least and at most (2, n) [N m]:
            what a drive adds by its own damping depends on a speed that is not known yet.
        moving: whether the drives follow setpoints; else all begins anew.
    """
    words = np.array(np.broadcast_arrays(seen.position, seen.velocity, seen.torque))
    same = (words == before.words).all(axis=0) & moving
    most = np.maximum(np.abs(seen.torque), _FOLLOWS * limits.torque)
    least, told = np.clip(before.told, -most, most)
    sure = np.where(before.told[0] > 0.0, before.told[0], np.minimum(before.told[1], 0.0))
    idle = moving & (np.abs(sure) > limits.notice) & (np.sign(sure) * seen.torque < _LITTLE * np.abs(sure))
    return Watch(
        words,
        np.where(same, before.since, seen.now),
        np.where(same, np.minimum(before.low, told), np.inf),
        np.where(same, np.maximum(before.high, least), -np.inf),
        np.where(idle, before.obeyed, seen.now),
        last,
    )


def frozen(limits: Limits, state: Watch, seen: Seen) -> np.ndarray:
    """Return which drives repeat themselves although this is impossible (n,)."""
    long = seen.now - state.since >= limits.frozen_s
    disobeys = state.high - state.low > limits.notice
    speed = np.where(np.isfinite(state.words[1]), np.abs(state.words[1]), 0.0)  # no number: another fault
    slips = (speed > _TURNS) & (speed * (seen.now - state.since) > _MOVED)
    return long & (disobeys | slips)


def let_go(state: Watch, seen: Seen) -> np.ndarray:
    """Return which drives have not followed their torque for long (n,)."""
    return seen.now - state.obeyed >= _LET_GO_S


def base_frozen(seen: Seen) -> bool:
    """Return whether an inertial unit repeats itself while joints move, which its noise rules out."""
    return seen.base_same >= BASE_S and bool((np.abs(seen.velocity) > _MOVES).any())
