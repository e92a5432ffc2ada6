"""Both drives, from command to the torque on their rotors, row by row.

Delay, then limits, then current-loop lag; here the torque is measured; then whatever reshapes it, gain,
derating and bias. Torque is held over pieces of a row, at its mean over the piece where it changes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import exp, floor

import numpy as np

from .machine import Derating, Machine, SpeedLimit

Pair = tuple[float, float]
_PIECE = 0.25e-3  # a torque that changes within a row is held this long [s]


class Drive:
    """Torque of both motors; it stores delayed commands, so use one per run.

    A delay is whole rows plus a rest; during the rest of each row the previous command still stands.

    Args:
        machine: the parts of the chain.
        period: of the rows [s].
        generator: draws what is random in a drive.
    """

    def __init__(self, machine: Machine, period: float, generator: np.random.Generator | None = None) -> None:
        whole = floor(machine.delay / period + 1e-6)
        self._rest = max(0.0, machine.delay - whole * period)
        if self._rest < 1e-9:
            self._rest = 0.0
        self._pending = [(0.0, 0.0)] * (whole + 2)  # clipped commands of the last rows, newest last
        self._period = period
        self._limit, self._lag, self._gain = machine.limit, machine.lag, machine.gain
        self._speed_limit = machine.speed_limit
        self._heat = [Heat(derating) for derating in machine.derating]
        self._current = (0.0, 0.0)
        self._speed, self._before, self._last = (0.0, 0.0), (0.0, 0.0), period  # now, a piece ago, its length
        self._lags = any(machine.lag)
        self._fine = self._lags or any(machine.speed_limit)
        generator = generator or np.random.default_rng(0)
        self._reshape = [(axis, make(generator)) for axis, make in machine.reshaped]
        self._plain = not (self._fine or any(machine.derating) or self._reshape)
        #: Whether the drive has to be told the motors' speeds.
        self.feels_speed = any(machine.speed_limit)

    def command(self, torque: Pair, again: bool = False) -> None:
        """Store the command of the row that begins; `again`: in place of one that was stored for it."""
        (low1, low2) = self._limit
        self._pending.append((min(max(torque[0], -low1), low1), min(max(torque[1], -low2), low2)))
        self._pending.pop(-2 if again else 0)

    def feel(self, v1: float, v2: float) -> None:
        """Store the speeds of the motors at the end of the last piece [rad/s]."""
        self._before, self._speed = self._speed, (v1, v2)

    @property
    def torque(self) -> Pair:
        """Return the reading of the torque sensor at the start of the row, just after an edge [N m]."""
        target = self._pending[0 if self._rest else 1]
        if self.feels_speed:
            target = self._within(target, self._speed)
        if not self._lags:
            return target
        (lag1, lag2), (now1, now2) = self._lag, self._current
        return now1 if lag1 else target[0], now2 if lag2 else target[1]

    def advance(self, bias: Iterable[float]) -> Iterable[tuple[float, float, float]]:
        """Return torques of both rotors [N m] and their durations [s], through one row.

        Args:
            bias: unmeasured torque of the row, added after the gain (2,) [N m].
        """
        b1, b2 = bias
        g1, g2 = self._gain
        if self._plain and not self._rest:  # the usual drive, and the row loop is hot
            u1, u2 = self._pending[1]
            return ((g1 * u1 + b1, g2 * u2 + b2, self._period),)
        pieces = [(self._pending[1], self._period - self._rest)]
        if self._rest:
            pieces.insert(0, (self._pending[0], self._rest))
        if self._plain:
            return [(g1 * u1 + b1, g2 * u2 + b2, duration) for (u1, u2), duration in pieces]
        return self._changing(pieces, (b1, b2))

    def _changing(self, pieces: list[tuple[Pair, float]], bias: Pair) -> Iterator[tuple[float, float, float]]:
        """Pieces of torques that depend on what went before; `feel` is heard between them."""
        for target, duration in pieces:
            count = max(1, round(duration / _PIECE)) if self._fine else 1
            part = duration / count
            for _ in range(count):
                allowed = self._within(target, self._speed_in(0.5 * part)) if self.feels_speed else target
                u1, u2 = self._reshaped(self._follow(allowed, part) if self._lags else allowed, part)
                kept1, kept2 = self._heat[0].kept(u1, part), self._heat[1].kept(u2, part)
                self._last = part
                yield self._gain[0] * kept1 * u1 + bias[0], self._gain[1] * kept2 * u2 + bias[1], part

    def _reshaped(self, torque: Pair, duration: float) -> Pair:
        """What the rotors get of a piece's measured torque [N m]."""
        if not self._reshape:
            return torque
        both = list(torque)
        for axis, reshape in self._reshape:
            both[axis] = reshape(both[axis], duration)
        return both[0], both[1]

    def _speed_in(self, time: float) -> Pair:
        """The motors' speeds some time from now [s], if they go on as they did [rad/s]."""
        (v1, v2), (old1, old2), more = self._speed, self._before, time / self._last
        return v1 + more * (v1 - old1), v2 + more * (v2 - old2)

    def _within(self, torque: Pair, speed: Pair) -> Pair:
        """Torque that the speeds allow [N m]."""
        first, second = map(speed_limited, torque, speed, self._speed_limit)
        return first, second

    def _follow(self, target: Pair, duration: float) -> Pair:
        """Moves the lagging torques towards `target` and returns their means over `duration`."""
        means, ends = [], []
        for goal, now, lag in zip(target, self._current, self._lag, strict=True):
            kept = exp(-duration / lag) if lag else 0.0
            ends.append(goal + (now - goal) * kept)
            means.append(goal + (now - goal) * (1 - kept) * lag / duration)
        self._current = (ends[0], ends[1])
        return means[0], means[1]


class Heat:
    """The square of one drive's torque through a first-order lag, and the gain that it leaves."""

    def __init__(self, derating: Derating | None) -> None:
        self._derating, self._filtered = derating, 0.0

    def kept(self, torque: float, duration: float) -> float:
        """Return the mean gain over `duration` [s] of constant `torque` [N m]; never below zero."""
        if self._derating is None:
            return 1.0
        goal, now, lag = torque * torque, self._filtered, self._derating.time_constant
        rest = exp(-duration / lag)
        self._filtered = goal + (now - goal) * rest
        mean = goal + (now - goal) * (1 - rest) * lag / duration
        return max(0.0, 1.0 - self._derating.coefficient * mean)


def speed_limited(torque: float, speed: float, limit: SpeedLimit | None) -> float:
    """Return what a drive gives of a torque: driving falls to none at the no-load speed, braking does not."""
    if limit is None:
        return torque
    share = speed / limit.no_load
    high, low = limit.stall * min(max(1.0 - share, 0.0), 1.0), limit.stall * min(max(1.0 + share, 0.0), 1.0)
    return min(max(torque, -low), high)
