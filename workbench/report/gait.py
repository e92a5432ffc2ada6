"""Measures of a gait as a table and as JSON."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Group

from workbench.core import FORMAT
from workbench.core.shown import Summary
from workbench.gait import Gait, Interval, Measure

from .json_parts import clean, picked
from .layout import table, text


def gait_table(result: Gait) -> Group:
    """Return a table with a line per measure: both recordings, the gap, that of the second run."""
    floor = [("hardware again", "right")] if result.again else []
    shown = table("measure", ("gap (95 %)", "right"), *floor)
    for m in result.measures:
        cells = [_cell(m.gap), *([_cell(m.floor)] if result.again else [])]
        shown.add_row(text(_name(m)), *cells)
    return Group(text(_title(result)), shown)


def summary(result: Gait) -> Summary:
    """Return a line per measure: what both recordings show, and the gap."""
    rows = [(_name(m), _cell(m.gap), _cell(m.floor)) for m in result.measures]
    head = ("measure", "gap (95 %)", "hardware again")
    return Summary(
        _title(result), " ".join(f"Not measured: {line}." for line in result.lacking), [(head, rows)]
    )


def _title(result: Gait) -> str:
    forward, yaw = result.command
    both = f"{result.hardware} against {result.simulator}"
    return f"{both}; speeds relative to {forward:.3g} m/s, {yaw:.3g} rad/s."


def gait_dict(result: Gait, not_predicted: str | None = None) -> dict[str, Any]:
    """Return the JSON of ``workbench compare --gait``.

    Args:
        result: the measures.
        not_predicted: why the swing leg's prediction could not be made with the model, if so.
    """
    return clean(
        {
            "format": FORMAT,
            "hardware": result.hardware,
            "simulator": result.simulator,
            "again": result.again,
            "command": list(result.command),
            "measures": [
                picked(m, "name", "unit", "seen_in", "hardware", "simulator", "gap", "floor")
                for m in result.measures
            ],
            "lacking": [*result.lacking, *([not_predicted] if not_predicted else [])],
        }
    )


def _name(m: Measure) -> str:
    name = f"{m.name} [{m.unit}]" if m.unit else m.name
    if m.hardware is None or m.simulator is None:
        return name
    return f"{name}: {m.hardware.value:.3g}, {m.simulator.value:.3g} {m.seen_in}".rstrip()


def _cell(value: Interval | None) -> str:
    if value is None:
        return ""
    if not np.isfinite(value.low):
        return f"{value.value:.3g}"
    return f"{value.value:.3g} ({value.low:.3g}, {value.high:.3g})"
