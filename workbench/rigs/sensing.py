"""Readings of the encoders before noise and rounding: delayed, nonlinear, filtered.

Position and velocity are those of the motors a delay ago. The encoder maps position, and velocity by the
slope of that map; then the velocity passes its filter.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from math import cos, exp, floor, sin

from .machine import Encoder, Machine

Motion = tuple[float, float, float, float]  # angles [rad] and speeds [rad/s] of both motors


class Sensing:
    """Delay, encoders and velocity filters of one run.

    Args:
        machine: its errors.
        period: of the rows [s].
        start: the motors at rest before the first row.

    Attributes:
        look: when in each row the sensors look [s after its start]; None for at its end.
        true: whether the rows show just what is seen, so that `measure` can be left out.
    """

    def __init__(self, machine: Machine, period: float, start: Motion) -> None:
        whole = floor(machine.sensor_delay / period + 1e-6)
        rest = machine.sensor_delay - whole * period
        self.look = period - rest if rest > 1e-9 else None
        self._late = deque([start] * whole)
        self._encoders = machine.encoders
        self._straight = all(_is_true(encoder) for encoder in machine.encoders)
        self._filters = [_VelocityFilter(lag, period) if lag else None for lag in machine.velocity_lag]
        self._filtered = any(machine.velocity_lag)
        self.true = self._straight and not self._filtered and not whole

    def measure(self, seen: Motion) -> Motion:
        """Return the reading of the row from the last sampled motion; call once per row."""
        if self._late:
            self._late.append(seen)
            seen = self._late.popleft()
        if not self._straight:
            seen = self._mapped(seen)
        if not self._filtered:
            return seen
        q1, q2, v1, v2 = seen
        first, second = self._filters
        return q1, q2, first.follow(q1, v1) if first else v1, second.follow(q2, v2) if second else v2

    def _mapped(self, seen: Motion) -> Motion:
        (q1, w1), (q2, w2) = (_read(e, seen[i], seen[i + 2]) for i, e in enumerate(self._encoders))
        return q1, q2, w1, w2


def cut(
    pieces: Iterable[tuple[float, float, float]], at: float
) -> Iterator[tuple[float, float, float, bool]]:
    """Return pieces of a row (two torques and a duration [s]), one of them divided at the sampling time.

    Args:
        pieces: as the drive gives them.
        at: time from the start of the row [s].

    Yields:
        Two torques, the duration, and whether the sensors look at its end.
    """
    left, looked = at, False
    for u1, u2, duration in pieces:
        if looked or left > duration + 1e-12:
            yield u1, u2, duration, False
        else:
            looked, rest = True, duration - left
            yield u1, u2, left, True
            if rest > 1e-12:
                yield u1, u2, rest, False
        left -= duration


def _is_true(encoder: Encoder) -> bool:
    return encoder.scale == 1.0 and encoder.offset == 0.0 and not encoder.eccentricity


def _read(encoder: Encoder, angle: float, speed: float) -> tuple[float, float]:
    """Position [rad] and velocity [rad/s] that an encoder shows of its motor's."""
    shown, slope = encoder.scale * angle + encoder.offset, encoder.scale
    for amplitude, phase in encoder.eccentricity:
        shown += amplitude * sin(angle + phase)
        slope += amplitude * cos(angle + phase)
    return shown, slope * speed


class _VelocityFilter:
    """lag f' = w - f, exact for speeds that are parabolas over a row: ends, and mean by the position."""

    def __init__(self, lag: float, period: float) -> None:
        self._lag, self._period, self._kept = lag, period, exp(-period / lag)
        self._last: tuple[float, float] | None = None  # position and speed a row ago
        self._shown = 0.0

    def follow(self, position: float, speed: float) -> float:
        """The filtered speed [rad/s] at a row with this position [rad] and speed [rad/s]."""
        if self._last is None:
            self._shown = speed
        else:
            before, old = self._last
            period, lag = self._period, self._lag
            bend = 3.0 * (old + speed - 2.0 * (position - before) / period) / period**2
            slope = (speed - old) / period - bend * period - 2.0 * bend * lag
            level = old - slope * lag
            end = level + slope * period + bend * period**2
            self._shown = end + (self._shown - level) * self._kept
        self._last = position, speed
        return self._shown
