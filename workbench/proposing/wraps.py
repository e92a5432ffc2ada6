"""Positions of encoders that wrap, unwrapped to see their motion; the range shows the unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.recordings.wrap import RANGES, RAW_RANGES, unwrapped, wrap_of

from .clean import Clean

_UNITS = {
    "rad": RANGES,
    "deg": tuple(360.0 * 2.0**k for k in range(-1, 4)),
    "turn": (1.0, 2.0),
    "counts": tuple(2.0**k for k in range(8, 33)),
}


def whole_positions(rows: Clean, positions: Sequence[str]) -> tuple[Clean, Mapping[str, float]]:
    """Return rows with unwrapped positions, and column -> range of those that wrapped.

    The reader makes them whole in the file itself, and says so.
    """
    data, wraps = dict(rows.columns), {}
    for name in positions:
        good = np.isfinite(data[name])
        wrap = wrap_of(data[name][good], RAW_RANGES)
        if wrap is not None:
            data[name] = data[name].copy()
            data[name][good] = unwrapped(data[name][good], wrap)
            wraps[name] = wrap.range
    return (replace(rows, columns=data), wraps) if wraps else (rows, {})


def unit_of_range(size: float) -> str:
    """Return the unit in which an encoder has a range of this size; ``""`` if none is known."""
    return next((unit for unit, ranges in _UNITS.items() if size in ranges), "")
