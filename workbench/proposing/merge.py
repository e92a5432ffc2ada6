"""Topics of different rates onto the rows of one: measurements along lines, what was asked for held."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .names import role_of
from .proposal import Answers
from .table import Series, Table


def merged(table: Table, series: Sequence[Series], time: str, answers: Answers | None = None) -> Table:
    """The table with the columns of several series.

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
        for name, values in each.columns.items():
            columns[name] = values[first] if each is main else onto(rows, each.stamps, values, name)
    notes = table.notes
    if len(usable) > 1 and not table.series:
        notes = (*notes, f"{len(usable)} series of rows are brought onto those of one.")
    several = tuple(usable) if len(usable) > 1 else ()
    return replace(table, columns=columns, notes=notes, series=several, plain=False)


def on_rows_of(table: Table, answers: Answers) -> Table:
    """The table on the rows of the axes that are asked for, where it has several series."""
    if not table.series:
        return table
    return merged(table, table.series, next(iter(table.columns)), answers)


def onto(rows: np.ndarray, stamps: np.ndarray, values: np.ndarray, name: str) -> np.ndarray:
    """A column at the times of other rows, in any unit: held where it was asked for, else along lines."""
    good = np.isfinite(values) & np.isfinite(stamps)
    stamps, first = np.unique(stamps[good], return_index=True)
    values = values[good][first]
    if len(stamps) < 2:
        return np.full(len(rows), np.nan)
    period = float(np.median(np.diff(stamps)))
    if role_of(name).role in ("reference", "feedforward"):
        at = np.searchsorted(stamps, rows + 1e-6 * period, side="right") - 1
        return np.where(at >= 0, values[np.clip(at, 0, None)], np.nan)
    inside = (rows >= stamps[0] - period) & (rows <= stamps[-1] + period)
    return np.where(inside, np.interp(rows, stamps, values), np.nan)


def is_wanted(name: str, answers: Answers) -> bool:
    """Whether a column is the position of an axis that is asked for, by its name."""
    stated = answers.columns.get("position")
    if stated:
        return name in stated
    axes = answers.axes or answers.model_axes
    words = _plain(name)
    return _is_position(name) and any(f"_{_plain(axis)}_" in f"_{words}_" for axis in axes)


def _wanted(series: Series, answers: Answers) -> int:
    return sum(is_wanted(name, answers) for name in series.columns)


def _has_position(series: Series) -> bool:
    return any(_is_position(name) for name in series.columns)


def _is_position(name: str) -> bool:
    role = role_of(name)
    return role.kind == "position" and role.role != "reference"


def _plain(name: str) -> str:
    return "_".join(re.findall(r"[a-z]+|\d+", name.lower()))
