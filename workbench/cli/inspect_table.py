"""An inspection as tables for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from workbench.inspection import Inspection, Remark

_ORDER = {"problem": 0, "warning": 1, "note": 2, "ok": 3}


def inspection_table(inspection: Inspection) -> Group:
    """Return one table per recording, worst remarks first; remarks on several axes share a line."""
    parts: list[Table | Text] = []
    for entry in inspection.recordings:
        table = Table(title=entry.recording, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
        for column in ("", "topic", "axis", "what the data say"):
            table.add_column(column, overflow="fold")
        for alike in _alike(sorted(entry.remarks, key=lambda r: _ORDER[r.severity])):
            axes = ", ".join(remark.axis for remark in alike if remark.axis)
            text = alike[0].text if len(alike) == 1 else _of_each(alike[0])
            table.add_row(alike[0].severity, alike[0].topic, Text(axes), Text(text))
        parts.append(table)
    sound = (
        "Nothing is wrong with these recordings."
        if inspection.sound
        else "Something is wrong: see the problems above."
        if any(r.severity == "problem" for e in inspection.recordings for r in e.remarks)
        else "Nothing is clearly wrong; read the warnings above."
    )
    return Group(*parts, Text(sound))


def _alike(remarks: Sequence[Remark]) -> list[list[Remark]]:
    """Return groups of remarks that differ only in their axis, in the order of their first."""
    groups: dict[tuple[str, str, str], list[Remark]] = {}
    for remark in remarks:
        groups.setdefault((remark.severity, remark.topic, _of_each(remark)), []).append(remark)
    return list(groups.values())


def _of_each(remark: Remark) -> str:
    """Return a remark's sentence with ``each`` in place of its axis."""
    if remark.axis is None:
        return remark.text
    return remark.text.replace(f"Axis '{remark.axis}'", "Each").replace(f"'{remark.axis}'", "each")
