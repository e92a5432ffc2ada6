"""Topics with different rates on the rows of one: measurements interpolated, commands held.

A loop reads a position and then publishes its command, so that a command's stamp comes after that of the row
which it is the answer to. It belongs to that row, not to the next.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .names import role_of
from .proposal import Answers
from .table import LoggedSeries, Table

_BEHIND = 0.75  # of a row's period: a command that comes no later is of that row
_SAME_RATE = 0.05  # two series this near in rate have a row each for each of the other's


def merged(table: Table, series: Sequence[LoggedSeries], time: str, answers: Answers | None = None) -> Table:
    """Return one table with the columns of several series.

    The rows are those of the series with measured positions of most of the axes that are asked for, among
    these of the fastest. Numbers are NaN where a series has not begun or has ended.

    Args:
        table: what else is known of the file; its columns are left out.
        series: what the columns are from.
        time: name of the column of stamps.
        answers: which axes or columns are asked for.
    """
    usable = [s for s in series if len(s.stamps) >= 2] or list(series)
    main = max(usable, key=lambda s: (_wanted(s, answers or Answers()), _has_position(s), len(s.stamps)))
    first = np.concatenate([[True], np.diff(main.stamps) > 0])
    rows = main.stamps[first]
    columns: dict[str, np.ndarray] = {time: rows}
    for each in [main, *(s for s in usable if s is not main)]:
        along = each is not main and _has_position(each)
        for name, values in each.columns.items():
            moved = values[first] if each is main else onto(rows, each.stamps, values, name, beside=along)
            columns[name] = moved
    notes = table.notes
    if len(usable) > 1 and not table.series:
        notes = (*notes, f"{len(usable)} series with different time stamps are resampled to the rows of one.")
    several = tuple(usable) if len(usable) > 1 else ()
    return replace(table, columns=columns, notes=notes, series=several, plain=False)


def on_rows_of(table: Table, answers: Answers) -> Table:
    """Return the table on the rows of the selected axes, if it has several series."""
    if not table.series:
        return table
    return merged(table, table.series, next(iter(table.columns)), answers)


def onto(
    rows: np.ndarray, stamps: np.ndarray, values: np.ndarray, name: str, *, beside: bool = False
) -> np.ndarray:
    """Return a column at the times of other rows, in any unit: held for commands, else interpolated.

    Args:
        rows: times (K,).
        stamps: of the column (N,).
        values: of the column (N,).
        name: of the column; it says whether this was asked for.
        beside: whether measured positions have the same stamps. What was asked for then goes along lines
            as these do, where it is as fast as the rows: between two rows a law holds as it does at them.

    Returns:
        Values (K,), NaN where the column has not begun or has ended.
    """
    good = np.isfinite(values) & np.isfinite(stamps)
    stamps, first = np.unique(stamps[good], return_index=True)
    values = values[good][first]
    if len(stamps) < 2:
        return np.full(len(rows), np.nan)
    period = float(np.median(np.diff(stamps)))
    row = _period(rows) or period
    if role_of(name).role in ("reference", "feedforward") and not (
        beside and abs(period - row) < _SAME_RATE * row
    ):
        late = _BEHIND * min(period, row)
        at = np.searchsorted(stamps, rows + late, side="right") - 1
        return np.where(at >= 0, values[np.clip(at, 0, None)], np.nan)
    inside = (rows >= stamps[0] - period) & (rows <= stamps[-1] + period)
    return np.where(inside, np.interp(rows, stamps, values), np.nan)


def _period(times: np.ndarray) -> float:
    """The usual distance of two stamps; nil where there is one only."""
    steps = np.diff(np.unique(times[np.isfinite(times)]))
    return float(np.median(steps)) if len(steps) else 0.0


def is_wanted(name: str, answers: Answers) -> bool:
    """Return whether a column is the position of a selected axis, by its name."""
    stated = answers.columns.get("position")
    if stated:
        return name in stated
    axes = answers.axes or answers.model_axes
    words = _plain(name)
    return _is_position(name) and any(f"_{_plain(axis)}_" in f"_{words}_" for axis in axes)


def _wanted(series: LoggedSeries, answers: Answers) -> int:
    return sum(is_wanted(name, answers) for name in series.columns)


def _has_position(series: LoggedSeries) -> bool:
    return any(_is_position(name) for name in series.columns)


def _is_position(name: str) -> bool:
    role = role_of(name)
    return role.kind == "position" and role.role != "reference"


def _plain(name: str) -> str:
    return "_".join(re.findall(r"[a-z]+|\d+", name.lower()))
