"""Well-known factors: what a ratio of 57.3 between two columns usually means."""

from __future__ import annotations

import math
from collections.abc import Sequence

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

#: The same of torques and forces: units that nobody states, over those of SI.
TORQUE: tuple[tuple[float, str], ...] = (
    (1.355818, "ft lbf and N m"),
    (8.850746, "in lbf and N m"),
    (4.448222, "lbf and N"),
    (9.80665, "kgf and N (kgf m and N m)"),
    (10.19716, "kgf cm and N m"),
    (141.6119, "ozf in and N m"),
    (100.0, "N cm and N m"),
    *(each for each in NAMED if each[0] != 100.0),
)

Named = Sequence[tuple[float, str]]


def name_factor(factor: float, named: Named = NAMED) -> str | None:
    """Return the mix-up that explains a factor, or None.

    Args:
        factor: ratio of what was found to what was expected; its sign does not matter.
        named: factors with their meanings.
    """
    return next(iter(name_factors(factor, named=named)), None)


def name_factors(factor: float, tolerance: float = 0.03, named: Named = NAMED) -> tuple[str, ...]:
    """Return every mix-up that may explain a factor, the nearest first, as in `name_factor`."""
    size = abs(factor)
    if size == 0 or not math.isfinite(size):
        return ()
    misses = sorted((abs(abs(math.log(size)) - math.log(known)), meaning) for known, meaning in named)
    return tuple(meaning for miss, meaning in misses if miss < tolerance)
