"""Delivery of results: the terminal, JSON, a page, other tools."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.core import Comparison, Diagnosis, Improvement, Result

from .common import check_outputs, keep_inputs, write_result

if TYPE_CHECKING:
    from workbench.report import Sheet


@dataclass(frozen=True)
class Outputs:
    """Where a result goes: files, as they were named, and unless `quiet` the terminal."""

    json: str | None = None
    html: str | None = None
    mcap: str | None = None
    rerun: str | None = None
    force: bool = False
    quiet: bool = False

    def check(self, *others: str | None) -> None:
        """Refuse files that exist, these and others, before anything is computed."""
        check_outputs(self.json, self.html, self.mcap, self.rerun, *others, force=self.force)

    def keep(self, files: Sequence[Path], *others: str | None) -> None:
        """Refuse files, these and others, that would overwrite what was read."""
        keep_inputs([self.json, self.html, self.mcap, self.rerun, *others], files)

    @property
    def printed(self) -> bool:
        """Return whether people read the standard output."""
        return not self.quiet and self.json != "-"


def deliver(
    result: Result,
    to: Outputs,
    *,
    files: Sequence[Path],
    seeds: Mapping[str, int],
    truth: Sequence[Mapping[str, Any]] | None = None,
    more: Mapping[str, Any] | None = None,
) -> None:
    """Print the table, and write JSON, page, MCAP and Rerun's file; `more` goes into the JSON only."""
    from workbench import report

    if isinstance(result, Comparison):
        table, content = report.compare_table(result), report.comparison_dict(result)
    elif isinstance(result, Diagnosis):
        table, content = report.diagnosis_table(result), report.diagnosis_dict(result)
    else:
        table, content = report.improvement_table(result), report.improvement_dict(result, truth)
    if to.printed:
        report.print_table(table)
        if truth is not None and isinstance(result, Improvement):
            report.print_table(report.truth_table(result, truth))
    if to.json:
        write_result({**content, **(more or {})}, to.json, files=files, seeds=seeds, force=to.force)
    if to.html:
        report.write_page(result, to.html, **_made_by(files, seeds), truth=truth, force=to.force)
    if to.mcap:
        report.write_mcap(result, to.mcap, force=to.force)
    if to.rerun:
        report.write_rerun(result, to.rerun, force=to.force)


def deliver_sheet(
    sheet: Sheet, html: str, *, files: Sequence[Path], seeds: Mapping[str, int] | None = None, force: bool
) -> None:
    """Write a page made of parts."""
    from workbench import report

    keep_inputs([html], files)
    report.write_sheet(sheet, html, **_made_by(files, seeds or {}), force=force)


def _made_by(files: Sequence[Path], seeds: Mapping[str, int]) -> dict[str, Any]:
    """Return the command line with which a page can be made again."""
    command = shlex.join(["workbench", *sys.argv[1:]])
    return {"command": command, "seeds": seeds, "inputs": files}
