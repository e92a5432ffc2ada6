"""Delivery of results: the terminal, JSON, a page, other tools."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.core import Comparison, Diagnosis, Improvement, Result

from .common import write_result

if TYPE_CHECKING:
    from workbench.report import Sheet


def deliver(
    result: Result,
    *,
    json: str | None,
    html: str | None,
    mcap: str | None = None,
    rerun: str | None = None,
    force: bool,
    quiet: bool,
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
    if not quiet and json != "-":
        report.print_table(table)
        if truth is not None and isinstance(result, Improvement):
            report.print_table(report.truth_table(result, truth))
    if json:
        write_result({**content, **(more or {})}, json, files=files, seeds=seeds, force=force)
    if html:
        report.write_page(result, html, **_made_by(files, seeds), truth=truth, force=force)
    if mcap:
        report.write_mcap(result, mcap, force=force)
    if rerun:
        report.write_rerun(result, rerun, force=force)


def deliver_sheet(
    sheet: Sheet,
    html: str,
    *,
    files: Sequence[Path],
    seeds: Mapping[str, int] | None = None,
    force: bool,
) -> None:
    """Write a page made of parts."""
    from workbench import report

    report.write_sheet(sheet, html, **_made_by(files, seeds or {}), force=force)


def _made_by(files: Sequence[Path], seeds: Mapping[str, int]) -> dict[str, Any]:
    """Return the command line with which a page can be made again."""
    command = shlex.join(["workbench", *sys.argv[1:]])
    return {"command": command, "seeds": seeds, "inputs": files}
