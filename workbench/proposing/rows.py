"""Rows of the axes in a table: log viewers write many topics into one table, each on its own rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from .merge import is_wanted, onto
from .names import Role
from .proposal import Answers
from .table import Table

_MOTION = ("position", "velocity", "torque")
_MOSTLY = 0.9  # of the rows with a position have a number of what is logged beside it
_DROPOUTS = 0.2  # of the rows lack a position: more are no faults of a sensor, but rows of something else


def on_rows_of_axes(table: Table, roles: Mapping[str, Role], time: str, answers: Answers) -> Table:
    """Return the table on the rows that have a position; values on other rows are transferred to these.

    Args:
        table: the columns.
        roles: column -> what its name says.
        time: the clock's column.
        answers: which axes or columns are asked for.
    """
    seen = {n: np.isfinite(v) for n, v in table.columns.items() if n != time}
    wanted = [n for n in seen if is_wanted(n, answers)] or [
        n for n in seen if roles[n].kind == "position" and roles[n].role != "reference"
    ]
    wanted = [n for n in wanted if seen[n].any()]
    if not wanted:
        return table
    t = table.columns[time]
    rows = seen[max(wanted, key=lambda n: seen[n].sum())] & np.isfinite(t)
    if rows.sum() < 2 or rows.all():
        return table
    beside = [n for n in seen if roles[n].kind in _MOTION and seen[n][rows].mean() >= _MOSTLY]
    measured = np.any([seen[n] for n in (*beside, *wanted)], axis=0) & np.isfinite(t)
    if rows.sum() >= (1 - _DROPOUTS) * measured.sum():
        rows = measured  # without a position at some: a gap
    others = ~rows & np.isfinite(t)
    if not others.any():
        return table
    columns: dict[str, np.ndarray] = {time: t[rows]}
    moved = []
    for name, values in table.columns.items():
        if name == time:
            continue
        columns[name] = values[rows]
        if seen[name].any() and seen[name][rows].mean() < 1 - _DROPOUTS:
            along = any(np.mean(seen[name] == seen[n]) > _MOSTLY for n in wanted)
            columns[name] = onto(t[rows], t, values, name, beside=along)
            moved.append(name)
    notes = list(table.notes)
    left = int((others & ~np.any([seen[n] for n in wanted], axis=0)).sum())
    if left:
        notes.append(f"{left} rows without a number of any axis are left out.")
    if moved:
        shown = ", ".join(moved[:4]) + (f" and {len(moved) - 4} more" if len(moved) > 4 else "")
        notes.append(f"Resampled to the rows of the axes: {shown}.")
    return replace(table, columns=columns, notes=tuple(notes), plain=False)
