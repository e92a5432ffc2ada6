"""``workbench diagnose``."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

from workbench.core import Diagnosis

from .common import (
    ForceOption,
    HoldoutOption,
    HtmlOption,
    JsonOption,
    McapOption,
    ModelArgument,
    QuietOption,
    RecordingsArgument,
    RerunOption,
    SeedOption,
    WholeOption,
    check_outputs,
    files_of,
    open_pair,
)
from .data_problems import data_problems
from .deliver import deliver, deliver_sheet
from .progress import progress, staged


def diagnose(
    model: ModelArgument,
    recordings: RecordingsArgument,
    holdout: HoldoutOption = None,
    json: JsonOption = None,
    html: HtmlOption = None,
    mcap: McapOption = None,
    rerun: RerunOption = None,
    shape: Annotated[
        str | None,
        typer.Option(
            "--shape",
            metavar="FILE",
            help="Picture (.png, .svg) of the torque that no effect explains: a description, not a cause.",
        ),
    ] = None,
    trace: Annotated[
        str | None,
        typer.Option(
            "--trace",
            metavar="FILE",
            help="Page of everything that was tried, the error that remained, and why it was rejected.",
        ),
    ] = None,
    whole: WholeOption = False,
    seed: SeedOption = 0,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Name the missing physical effect, how certain it is, what else it could be, and what to measure next.

    Example: workbench diagnose leg chirp_hip.toml slow.toml --holdout validation.toml --json finding.json
    """
    from workbench.diagnosis import diagnose as run
    from workbench.effects import load_model
    from workbench.report import trace_sheet

    check_outputs(json, html, mcap, rerun, shape, trace, force=force)
    loaded = load_model(model)
    data = open_pair(recordings, holdout, whole=whole)
    with progress(quiet) as tell:
        result = run(loaded, data.training, data.held_out, seed=seed, progress=staged(tell))
    used = [*data.training, *data.held_out]
    problems = () if result.verdict == "consistent" else data_problems(loaded, used)
    result = replace(result, used=data.share, notes=(*problems, *result.notes, *data.notes))
    files, seeds = files_of(loaded, used), {"noise": seed}
    deliver(
        result,
        json=json,
        html=html,
        mcap=mcap,
        rerun=rerun,
        force=force,
        quiet=quiet,
        files=files,
        seeds=seeds,
    )
    if trace is not None:
        deliver_sheet(trace_sheet(result), trace, files=files, seeds=seeds, force=force)
    if shape is not None:
        _draw(result, shape, force, quiet or json == "-")


def _draw(result: Diagnosis, path: str, force: bool, quiet: bool) -> None:
    from workbench.report import save_figure, shape_figure

    if result.shapes:
        save_figure(shape_figure(result), path, force=force)
    elif not quiet:
        typer.echo("No shape was drawn: the unexplained torque has no smooth part.")
