"""What an import assumed, as a table for the terminal."""

from __future__ import annotations

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from workbench.core import Recording
from workbench.inspection import Inspection
from workbench.proposing import Proposal


def proposal_tables(proposal: Proposal, recording: Recording, found: Inspection) -> Group:
    """What was taken for what and how sure that is; then what was done and what looks wrong."""
    seconds, rate = recording.duration, 1.0 / recording.period
    title = f"{recording.name}: {len(recording)} rows, {seconds:.4g} s at {rate:.4g} Hz"
    table = assumed_table(proposal, title)
    parts: list[Table | Text] = [table]
    parts += [Text(note) for note in (*proposal.notes, *recording.notes)]
    remarks = [r for r in found.recordings[0].remarks if r.severity in ("problem", "warning")]
    parts += [Text(f"{remark.severity}: {remark.text}") for remark in remarks]
    return Group(*parts)


def assumed_table(proposal: Proposal, title: str) -> Table:
    """What was taken for what, and how sure that is."""
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("what", "taken for", "how sure", "because"):
        table.add_column(name, overflow="fold")
    for a in proposal.assumptions:
        table.add_row(a.what, Text(a.value), a.word, Text(a.because))
    return table
