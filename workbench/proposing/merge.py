"""Topics of different rates onto the rows of one: measurements along lines, what was asked for held."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .names import role_of
from .table import Series, Table


def merged(path: Path, series: Sequence[Series]) -> Table:
    """One table from several series.

    The rows are those of the fastest series with measured positions, else of the fastest. Numbers are NaN
    where a series has not begun or has ended.
    """
    usable = [s for s in series if len(s.stamps) >= 2]
    if not usable:
        usable = list(series)
    main = max(usable, key=lambda s: (_has_position(s), len(s.stamps)))
    first = np.concatenate([[True], np.diff(main.stamps) > 0])
    rows = main.stamps[first]
    columns: dict[str, np.ndarray] = {}
    for each in [main, *(s for s in usable if s is not main)]:
        for name, values in each.columns.items():
            columns[name] = values[first] if each is main else _onto(rows, each.stamps, values, name)
    notes: tuple[str, ...] = ()
    if len(usable) > 1:
        notes = (f"{len(usable)} topics are brought onto the rows of one.",)
    return Table(path, {"log time": rows - rows[0], **columns}, {"log time": "s"}, False, "log time", notes)


def _has_position(series: Series) -> bool:
    roles = [role_of(name) for name in series.columns]
    return any(r.kind == "position" and r.role != "reference" for r in roles)


def _onto(rows: np.ndarray, stamps: np.ndarray, values: np.ndarray, name: str) -> np.ndarray:
    good = np.isfinite(values)
    stamps, first = np.unique(stamps[good], return_index=True)
    values = values[good][first]
    if len(stamps) < 2:
        return np.full(len(rows), np.nan)
    period = float(np.median(np.diff(stamps)))
    if role_of(name).role in ("reference", "feedforward"):
        at = np.searchsorted(stamps, rows + 1e-9, side="right") - 1
        return np.where(at >= 0, values[np.clip(at, 0, None)], np.nan)
    inside = (rows >= stamps[0] - period) & (rows <= stamps[-1] + period)
    return np.where(inside, np.interp(rows, stamps, values), np.nan)
