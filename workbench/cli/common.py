"""What commands share: options, reading inputs, progress, and where results go."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from workbench.core import Comparison, Diagnosis, Improvement, InputError, Recording
from workbench.core.files import check_free

if TYPE_CHECKING:
    from workbench.report import Sheet

ModelArgument = Annotated[
    str, typer.Argument(metavar="MODEL", help="Model file (.toml or .xml), or a shipped model's name.")
]
RecordingsArgument = Annotated[list[str], typer.Argument(metavar="REC...", help="Recording files (.toml).")]
HoldoutOption = Annotated[
    list[str] | None,
    typer.Option(
        "--holdout", metavar="REC", help="Recording that judges and is not fitted; may be given again."
    ),
]
JsonOption = Annotated[
    str | None,
    typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for standard output."),
]
HtmlOption = Annotated[
    str | None, typer.Option("--html", metavar="FILE", help="Write the result as a self-contained page.")
]
ForceOption = Annotated[bool, typer.Option("--force", help="Overwrite outputs that exist.")]
SeedOption = Annotated[int, typer.Option("--seed", min=0, help="Seed of the noise simulations.")]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]


def read_recordings(paths: Sequence[str]) -> list[Recording]:
    """Read recordings; each file once.

    Raises:
        InputError: one of them is bad, or stands twice.
    """
    from workbench.recordings import load_recordings

    resolved = [Path(p).resolve() for p in paths]
    twice = [p for p, r in zip(paths, resolved, strict=True) if resolved.count(r) > 1]
    if twice:
        raise InputError("the recording is given twice", file=twice[0], remedy="name each recording once")
    return load_recordings(list(paths))


def read_pair(
    training: Sequence[str], held_out: Sequence[str] | None
) -> tuple[list[Recording], list[Recording]]:
    """Recordings to fit and to judge by.

    Raises:
        InputError: one of them is bad, or is given for both.
    """
    both = read_recordings([*training, *(held_out or [])])
    return both[: len(training)], both[len(training) :]


def check_outputs(*paths: str | None, force: bool) -> None:
    """Refuse outputs that exist, before anything is computed."""
    for path in paths:
        if path and path != "-":
            check_free(path, force=force)


@contextmanager
def progress(quiet: bool) -> Iterator[Any]:
    """A line that says what is being done and for how long; silent where no one watches."""
    from rich.console import Console

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda text: None
        return
    with console.status("starting") as status:
        yield lambda text: status.update(text)


def deliver(
    result: Comparison | Diagnosis | Improvement,
    *,
    json: str | None,
    html: str | None,
    force: bool,
    quiet: bool,
    inputs: Sequence[str],
    seeds: Mapping[str, int],
    truth: Sequence[Mapping[str, Any]] | None = None,
) -> None:
    """Print the table, write JSON and page."""
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
        report.write_json(content, json, force=force)
    if html:
        report.write_page(result, html, **_made_by(inputs, seeds), truth=truth, force=force)


def deliver_sheet(
    sheet: Sheet, html: str, *, inputs: Sequence[str], seeds: Mapping[str, int] | None = None, force: bool
) -> None:
    """Write a page made of parts."""
    from workbench import report

    report.write_sheet(sheet, html, **_made_by(inputs, seeds or {}), force=force)


def _made_by(inputs: Sequence[str], seeds: Mapping[str, int]) -> dict[str, Any]:
    """How a page says that it can be made again."""
    files = [Path(p) for p in inputs if Path(p).is_file()]
    return {"command": " ".join(["workbench", *sys.argv[1:]]), "seeds": seeds, "inputs": files}
