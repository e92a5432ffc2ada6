"""Positions in encoder steps: how many steps make a turn, if the numbers cover one."""

from __future__ import annotations

import numpy as np

#: Steps per turn of encoders: powers of two if absolute, four per line if incremental.
TURNS = tuple(2**k for k in range(10, 25)) + tuple(4 * lines for lines in (500, 1000, 2500, 5000, 10000))
_NUMBERS = (2**16, 2**32)  # a count of so many bits begins anew wherever a turn ends
_SURELY = 4096  # fractions are interpolated counts only of a turn that no angle in degrees is as long as
_OVER = 0.9  # of a turn is run over,
_NEAR = 0.02  # to one of its ends to so much of it,
_BEYOND = 0.002  # and past both by no more: a filter of speed overshoots by some counts


def turn_of(values: np.ndarray) -> int:
    """Return steps per turn of positions that cover a complete turn; 0 otherwise.

    Args:
        values: all columns, shape (N, n). Each ends just below the turn, or half of it either way; of whole
            numbers one that does will do, where no other goes beyond.
    """
    found = set()
    for column in values.T:
        finite = column[np.isfinite(column)]
        if not len(finite):
            return 0
        low, high = float(finite.min()), float(finite.max())
        whole = bool(np.all(finite == np.round(finite)))
        found.add(
            next((n for n in sorted(TURNS) if (whole or n >= _SURELY) and _fills(low, high, n, whole)), 0)
        )
    if np.array_equal(values, np.round(values), equal_nan=True) and np.nanmax(np.abs(values)) < max(found):
        found -= {0}
    return found.pop() if len(found) == 1 else 0


def turn_that_wraps(size: int) -> int:
    """Return steps per turn of an encoder that wraps at `size`; 0 if only the number may overflow."""
    return size if size in TURNS and size not in _NUMBERS else 0


def _fills(low: float, high: float, turn: int, whole: bool) -> bool:
    """Whether numbers run over a turn that begins at nothing, or half of it before, and stay in it.

    Fractions are counted from nothing: what goes either way like that is an angle more often.
    """
    for start in (0.0, -0.5 * turn)[: 1 + whole]:
        first, last = (low - start) / turn, (high - start) / turn
        inside = first >= -_BEYOND and last <= 1 + _BEYOND
        if inside and last - first >= _OVER and min(first, 1 - last) <= _NEAR:
            return True
    return False
