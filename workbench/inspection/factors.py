"""Factors that have a name: what a ratio of 57.3 between two columns usually means."""

from __future__ import annotations

import math

#: Factor -> what it comes from. The inverse of each is looked up too.
NAMED: tuple[tuple[float, str], ...] = (
    (180 / math.pi, "degrees and radians"),
    (60 / (2 * math.pi), "rpm and rad/s"),
    (2 * math.pi, "revolutions and radians"),
    (6.0, "rpm and deg/s"),
    (360.0, "revolutions and degrees"),
    (10.0, "a factor of ten, as of a decimal point"),
    (1000.0, "milli (mN m, mm or ms) and the whole unit"),
    (100.0, "cm and m"),
)


def name_factor(factor: float, tolerance: float = 0.03) -> str | None:
    """What mix-up a factor comes from, or None.

    Args:
        factor: ratio of what was found to what was expected; its sign does not matter.
        tolerance: relative.
    """
    return next(iter(name_factors(factor, tolerance)), None)


def name_factors(factor: float, tolerance: float = 0.03) -> tuple[str, ...]:
    """Every mix-up that a factor may come from, the nearest first; as `name_factor`."""
    size = abs(factor)
    if size == 0 or not math.isfinite(size):
        return ()
    misses = sorted((abs(abs(math.log(size)) - math.log(named)), meaning) for named, meaning in NAMED)
    return tuple(meaning for miss, meaning in misses if miss < tolerance)
