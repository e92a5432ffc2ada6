"""The table of numbers: residual of each signal, per recording and axis."""

from __future__ import annotations

import math
from typing import Any

from workbench.core import Comparison
from workbench.core.units import torque_unit

from .numbers import handy, number, plain, quantity
from .pack import partner


def scores(before: Comparison | None, after: Comparison | None) -> dict[str, Any]:
    """Return one row per recording and axis: residual of each signal, noise, and the units of the columns."""
    entries = before.recordings if before else ()
    tables = [_score_table(before, after, name) for name in ("position", "torque")] if before else []
    rows = []
    for i, entry in enumerate(entries):
        later = partner(after, before, i) if before else None
        errors = [number(e.error) for e in (entry, *([later] if later else []))] + [number(entry.noise_error)]
        for k, axis in enumerate(entry.recording.axes):
            rows.append(
                {
                    "recording": plain(entry.recording.name),
                    "axis": plain(axis),
                    "cells": [cell for _, cells in tables for cell in cells[len(rows)]],
                    "first": k == 0,
                    "span": len(entry.recording.axes),
                    "errors": errors if later or not after else [errors[0], "–", errors[1]],
                }
            )
    return {"rows": rows, "units": [unit for unit, _ in tables]}


def _score_table(before: Comparison, after: Comparison | None, name: str) -> tuple[str, list[list[str]]]:
    """Unit for the heading, or nothing where axes differ and each cell has its own; and the cells."""
    values, units = [], []
    for i, entry in enumerate(before.recordings):
        later = partner(after, before, i)
        for k in range(len(entry.recording.axes)):
            unit = entry.recording.units[k]
            units.append(unit if name == "position" else torque_unit(unit))
            runs = [(entry, "rmse")] + ([(later, "rmse")] if after else []) + [(entry, "noise")]
            values.append(
                [float(getattr(run, f"{name}_{kind}")[k]) if run else math.nan for run, kind in runs]
            )
    if len(set(units)) > 1:
        cells = [[quantity(v, u) for v in row] for row, u in zip(values, units, strict=True)]
        return "", cells
    factor, unit = handy([v for row in values for v in row], units[0] if units else "")
    least = min((abs(v) for row in values for v in row if math.isfinite(v) and v != 0), default=1.0)
    places = min(5, max(0, 2 - math.floor(math.log10(factor * least))))
    return unit, [[f"{factor * v:.{places}f}" if math.isfinite(v) else "–" for v in row] for row in values]
