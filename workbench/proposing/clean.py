"""Makes the rows of a recording from those of a table: increasing time, no duplicates, gaps marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.text import counted

_SOME = 0.05  # share of repeated stamps from which the clock is taken to be too coarse
_SPARSE = 0.2  # share of empty cells from which a column is taken to be logged more slowly


@dataclass(frozen=True)
class Clean:
    """Rows that can be read.

    Attributes:
        columns: name -> values (K,), the time column first.
        valid: rows that were measured (K,) bool, or None where all were and no gap is among them.
        changed: whether anything differs from the file, so that a table has to be written.
        notes: what was done, one sentence each.
        runs: rows of each run that is in the file, one after the other; one is taken.
    """

    columns: Mapping[str, np.ndarray]
    valid: np.ndarray | None
    changed: bool
    notes: tuple[str, ...]
    runs: tuple[int, ...]


def clean(columns: Mapping[str, np.ndarray], time: str, used: Sequence[str], run: int | None = None) -> Clean:
    """Return the rows in order.

    Args:
        columns: name -> values (N,).
        time: the time column, in any unit.
        used: the other columns that the recording names.
        run: which run, where time starts anew; else the longest.
    """
    notes: list[str] = []
    t = columns[time]
    rows, changed, runs = _in_order(t, notes, run)
    t = t[rows]
    data = {name: columns[name][rows] for name in used}
    t, kept = _without_repeats(t, notes)
    changed |= len(kept) != len(rows) or not np.array_equal(t, columns[time][rows][kept])
    data = {name: values[kept] for name, values in data.items()}
    for name, values in data.items():
        empty = ~np.isfinite(values)
        if _SPARSE < empty.mean() < 0.99 and _evenly(empty):
            data[name] = _between(t, values, empty)
            notes.append(
                f"'{name}' is logged more slowly than the rest; its values are interpolated linearly."
            )
            changed = True
    good = np.all([np.isfinite(v) for v in data.values()], axis=0) if data else np.ones(len(t), bool)
    if good.any() and not good.all():
        first, last = int(np.argmax(good)), len(good) - int(np.argmax(good[::-1]))
        if first or last < len(good):
            notes.append(f"{len(good) - (last - first)} rows before and after the measurement are left out.")
            changed = True
        t, good = t[first:last], good[first:last]
        data = {name: values[first:last] for name, values in data.items()}
    valid = None
    if not good.all():
        count = int((~good).sum())
        some = "1 row in which a cell" if count == 1 else f"{count} rows in which cells"
        lacks, marked = ("holds", "is") if count == 1 else ("hold", "are")
        notes.append(f"{some} {lacks} no number {marked} marked as not measured.")
        valid = good
    step = np.diff(t)
    if len(step) and step.max() > max(1.5 * np.median(step), 1.3 * np.quantile(step, 0.95)):
        gaps = int((step > max(1.5 * np.median(step), 1.3 * np.quantile(step, 0.95))).sum())
        notes.append(f"{counted(gaps, 'gap')} in time marked as not measured.")
        valid = good
    return Clean({time: t, **data}, valid, changed or valid is not None, tuple(notes), runs)


def _in_order(t: np.ndarray, notes: list[str], run: int | None) -> tuple[np.ndarray, bool, tuple[int, ...]]:
    """Indices of the rows to keep, in order of time; whether any differ; and rows of each run."""
    rows = np.flatnonzero(np.isfinite(t))
    changed = len(rows) < len(t)
    if changed:
        notes.append(f"{len(t) - len(rows)} rows without a time are left out.")
    back = np.flatnonzero(np.diff(t[rows]) < 0)
    if len(back) == 0:
        return rows, changed, (len(rows),)
    # a clock that starts again: several runs in one file
    edges = np.concatenate([[0], back + 1, [len(rows)]])
    sizes = np.diff(edges)
    if sizes.max() > 0.05 * len(rows) and len(back) < 50 and _restarts(t[rows], back):
        taken = int(np.argmax(sizes)) if run is None else min(run, len(sizes) - 1)
        which = "the longest" if run is None else f"number {run}, counted from 0,"
        notes.append(f"Time restarts {counted(len(back), 'time')}; {which} of {len(sizes)} runs is taken.")
        return rows[edges[taken] : edges[taken + 1]], True, tuple(int(size) for size in sizes)
    notes.append(f"Time goes back at {counted(len(back), 'row')}; rows are sorted by time.")
    return rows[np.argsort(t[rows], kind="stable")], True, (len(rows),)


def _restarts(t: np.ndarray, back: np.ndarray) -> bool:
    """Whether time falls back to where it began, rather than by a row or two."""
    return bool(np.all(t[back] - t[back + 1] > 0.5 * (t[back] - t[0])))


def _without_repeats(t: np.ndarray, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Times that increase, and the rows that they belong to."""
    every = np.arange(len(t))
    repeats = np.concatenate([[False], np.diff(t) == 0])
    if not repeats.any():
        return t, every
    if repeats.mean() > _SOME:
        line = np.polynomial.Polynomial.fit(every, t, 1)
        even = line(every)
        distinct = np.unique(t)
        quantum = float(np.median(np.diff(distinct))) if len(distinct) > 1 else 0.0
        if np.abs(even - t).max() < 2.5 * quantum:
            notes.append("Time stamps are coarser than the rows; they are replaced by evenly spaced times.")
            return even, every
    notes.append(f"{int(repeats.sum())} rows that repeat a time stamp are left out.")
    return t[~repeats], every[~repeats]


def _evenly(empty: np.ndarray) -> bool:
    """Whether numbers come at regular distances between empty cells."""
    at = np.flatnonzero(~empty)
    if len(at) <= 10:
        return False
    usual = float(np.median(np.diff(at)))  # rows; numbers in each that then end are no slower log
    return usual > 1 and float(np.quantile(np.diff(at), 0.99)) <= 2.0 * usual + 1


def _between(t: np.ndarray, values: np.ndarray, empty: np.ndarray) -> np.ndarray:
    """Lines (N,) between a slower column's numbers; NaN farther from their ends than its step."""
    known = t[~empty]
    drawn, step = np.interp(t, known, values[~empty]), float(np.median(np.diff(known)))
    drawn[(t < known[0] - step) | (t > known[-1] + step)] = np.nan
    return drawn
