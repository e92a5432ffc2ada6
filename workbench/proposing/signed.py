"""Signed counts that were written as unsigned: values slightly below zero appear near the top."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .table import Table

_BITS = 16, 32
_FEWEST = 3  # different numbers near the top: one alone is a mark for what was not measured


def signed_counts(table: Table) -> Table:
    """Return the table with its 16 or 32 bit integers as signed ones, if they jump over nearly this range.

    Numbers either side of zero leave the middle of the unsigned range empty, which no encoder that turns on
    does, and go both ways, which no counter does.
    """
    columns, notes = dict(table.columns), list(table.notes)
    for name, values in columns.items():
        bits = _bits_of(values)
        if bits:
            columns[name] = np.where(values >= 2.0 ** (bits - 1), values - 2.0**bits, values)
            notes.append(
                f"'{name}' jumps by nearly {2**bits} around zero: it is a signed number of {bits} bits, "
                f"written without its sign; {2**bits} is subtracted from numbers above "
                f"{2 ** (bits - 1) - 1}."
            )
    if len(notes) == len(table.notes):
        return table
    return replace(table, columns=columns, notes=tuple(notes), plain=False)


def _bits_of(values: np.ndarray) -> int:
    """Bits of a signed number that stands there without its sign; 0 where it is none."""
    known = values[np.isfinite(values)]
    if not len(known) or known.min() < 0 or np.any(known != np.round(known)):
        return 0
    for bits in _BITS:
        whole, half = 2.0**bits, 2.0 ** (bits - 1)
        above, below = known[known >= half], known[known < half]
        if not len(above) or not len(below) or above.max() >= whole:
            continue
        steps = np.diff(known)
        jumps = np.abs(steps) > half
        turns = np.any(steps[~jumps] > 0) and np.any(steps[~jumps] < 0)  # a counter only rises
        if above.min() - below.max() > half and jumps.any() and turns and len(np.unique(above)) >= _FEWEST:
            return bits
    return 0
