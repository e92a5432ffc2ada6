"""An inspection as tables for the terminal."""

from __future__ import annotations

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from workbench.inspection import Inspection

_ORDER = {"problem": 0, "warning": 1, "note": 2, "ok": 3}


def inspection_table(inspection: Inspection) -> Group:
    """One table a recording, worst remarks first."""
    parts: list[Table | Text] = []
    for entry in inspection.recordings:
        table = Table(title=entry.recording, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
        for column in ("", "topic", "axis", "what the data say"):
            table.add_column(column, overflow="fold")
        for remark in sorted(entry.remarks, key=lambda r: _ORDER[r.severity]):
            table.add_row(remark.severity, remark.topic, remark.axis or "", Text(remark.text))
        parts.append(table)
    sound = (
        "Nothing is wrong with these recordings."
        if inspection.sound
        else "Something is wrong: see the problems above."
        if any(r.severity == "problem" for e in inspection.recordings for r in e.remarks)
        else "Nothing is plainly wrong; look at the warnings above."
    )
    return Group(*parts, Text(sound))
