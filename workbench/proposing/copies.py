"""Repeated rows: a logger that is faster than its data writes each row several times."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from workbench.core import AXIS_SIGNALS

from .names import Role
from .proposal import Answers
from .table import Table

_KINDS = ("position", "velocity", "torque", "current")

_FEW = 50  # changes from row to row that say nothing
_MOSTLY = 0.9  # of the changes are as many rows apart


def each_row_once(table: Table, roles: Mapping[str, Role], answers: Answers) -> Table:
    """Return the table without repeated rows, if nearly all are repeated; and a note.

    Args:
        table: the columns.
        roles: column -> what its name says; what is logged of the axes tells.
        answers: columns that the user names.
    """
    stated = {n for signal, names in answers.columns.items() if signal in AXIS_SIGNALS for n in names}
    told = [v for n, v in table.columns.items() if roles[n].kind in _KINDS or n in stated]
    count, first = copied_rows(told)
    if count < 2:
        return table
    often = "twice" if count == 2 else f"{count} times"
    note = (
        f"Every row is repeated {often}, as when a logger is faster than the data: one copy of each is kept."
    )
    columns = {name: values[first::count] for name, values in table.columns.items()}
    return replace(table, columns=columns, notes=(*table.notes, note), plain=False)


def copied_rows(columns: Collection[np.ndarray]) -> tuple[int, int]:
    """Return how often each row is repeated, and the first row of such a group.

    Sensors that are read anew differ from row to row by their noise, at least on one axis; a coarse encoder
    that turns slowly stays for a number of rows that changes with its speed.

    Args:
        columns: all that was logged of the axes, each (N,).

    Returns:
        ``(count, first)``; ``(1, 0)`` where rows are no copies.
    """
    anew = np.zeros(max(len(next(iter(columns), ())) - 1, 0), bool)
    for values in columns:
        before, after = values[:-1], values[1:]
        anew |= (before != after) & ~(np.isnan(before) & np.isnan(after))
    changes = np.flatnonzero(anew) + 1
    apart = np.diff(changes)
    if len(apart) < _FEW:
        return 1, 0
    count = int(np.median(apart))
    if count < 2 or np.mean(apart == count) < _MOSTLY:
        return 1, 0
    return count, int(np.bincount(changes % count).argmax())
