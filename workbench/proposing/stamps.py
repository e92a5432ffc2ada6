"""Clocks in parts: seconds and their fraction in two columns, or a counter that overflows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from .names import role_of
from .table import Table

_WHOLE = ("sec", "secs", "s", "seconds")
_PARTS = {
    "nanosec": 9, "nanosecs": 9, "nsec": 9, "nsecs": 9, "ns": 9, "nanos": 9, "nanoseconds": 9,
    "usec": 6, "usecs": 6, "us": 6, "micros": 6, "microseconds": 6,
    "msec": 3, "msecs": 3, "ms": 3, "millis": 3, "milliseconds": 3,
}  # fmt: skip
_MOST = 0.95  # of the rows behave
#: Ticks after which counters begin anew: of 16 and 32 bits; of a fraction of a second that is logged alone.
_PERIODS = (2.0**16, 2.0**32, 1e6, 1e9)


def whole_clocks(table: Table) -> Table:
    """Return the table with one column instead of two that are a clock, and with counters continued.

    Without a header, numbers tell: the fraction falls where the seconds rise.
    """
    if table.clock is not None:
        return table
    columns, notes, units = dict(table.columns), list(table.notes), dict(table.units)
    for seconds, part, digits in list(_pairs(table)):
        if seconds not in columns or part not in columns:
            continue
        a, b = columns[seconds], columns[part]
        name = _name(seconds, columns)
        del columns[seconds], columns[part]
        # in a double, seconds since 1970 have no nanoseconds left
        columns = {name: (a - np.nanmin(a)) + b * 10.0**-digits, **columns}
        units[name] = "s"
        notes.append(f"'{name}' is made of '{seconds}' and '{part}'.")
    for name, values in columns.items():
        if role_of(name).kind == "time" and (found := _going_on(values)) is not None:
            columns[name], period = found
            notes.append(
                f"'{name}' restarts every {period:.0f} of its units; it is read as one continuous clock."
            )
    if len(notes) == len(table.notes):
        return table
    return replace(table, columns=columns, notes=tuple(notes), units=units, plain=False)


def _pairs(table: Table) -> Iterator[tuple[str, str, int]]:
    """Columns of whole seconds, of the rest, and how many digits the rest has."""
    whole = {n: v for n, v in table.columns.items() if _is_whole(v)}
    for a, seconds in whole.items():
        words = role_of(a).words
        for b, part in whole.items():
            other = role_of(b).words
            if words[-1:] and other[-1:] and words[-1] in _WHOLE and other[-1] in _PARTS:
                digits = _PARTS[other[-1]]
                if words[:-1] == other[:-1] and np.nanmax(part) < 10**digits:
                    yield a, b, digits
            elif a.startswith("column_") and b.startswith("column_") and (digits := _carries(seconds, part)):
                yield a, b, digits


def _carries(seconds: np.ndarray, part: np.ndarray) -> int:
    """Digits of a fraction that falls where, and only where, the seconds rise; 0 where it is none."""
    both = np.isfinite(seconds) & np.isfinite(part)
    up, step = np.diff(seconds[both]) > 0, np.diff(part[both])
    if up.sum() < 2 or step[~up].size == 0 or not (step > 0).any():
        return 0
    if np.mean(step[up] < 0) < _MOST or np.mean(step[~up] > 0) < _MOST:
        return 0
    top = float(part[both].max())
    return next((k for k in (3, 6, 9) if 0.9 * 10**k < top < 10**k), 0)


def _is_whole(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    return len(finite) > 8 and bool(np.all(finite == np.round(finite))) and bool(finite.min() >= 0)


def _going_on(values: np.ndarray) -> tuple[np.ndarray, float] | None:
    """A counter without its falls, and their size; None where it does not fall, or not as counters do."""
    good = np.isfinite(values)
    step = np.diff(values[good])
    falls = step < 0
    if not falls.any() or falls.all() or np.any(values[good] != np.round(values[good])):
        return None
    usual = float(np.median(step[~falls]))
    for period in _PERIODS:
        # the step over the end is one like the others, or a few where rows were lost
        over = step[falls] + period
        if np.all((over > 0) & (over < 5 * usual)) and (period not in (1e6, 1e9) or falls.sum() > 1):
            out = values.copy()
            out[good] += period * np.concatenate([[0], np.cumsum(falls)])
            return out, period
    return None


def _name(seconds: str, taken: dict[str, np.ndarray]) -> str:
    stem = "" if seconds.startswith("column_") else seconds.rstrip("]")[: -len(role_of(seconds).words[-1])]
    name = stem.strip("._/-[ ") or "time"
    if role_of(name).kind != "time":
        name += ".time"
    while name in taken:
        name += "_"
    return name
