"""``workbench diagnose``."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

from workbench.core import Diagnosis

from . import options
from .common import files_of, open_pair
from .data_problems import data_problems
from .deliver import Outputs, deliver, deliver_sheet
from .progress import progress, staged


def diagnose(
    model: options.Model,
    recordings: options.Recordings,
    holdout: options.Holdout = None,
    json: options.Json = None,
    html: options.Html = None,
    mcap: options.Mcap = None,
    rerun: options.Rerun = None,
    shape: Annotated[
        str | None,
        options.written(
            format_="figure",
            metavar="FILE",
            help="Picture (.png, .svg, .pdf) of the torque that no effect explains; it describes, it "
            "names no cause.",
        ),
    ] = None,
    trace: Annotated[
        str | None,
        options.written(
            metavar="FILE",
            help="Page of everything that was tried, the error that remained, and why it was rejected.",
        ),
    ] = None,
    whole: options.Whole = False,
    seed: options.Seed = 0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Name the missing physical effect, how certain it is, what else it could be, and what to measure next.

    Example: workbench diagnose leg chirp_hip.toml slow.toml --holdout validation.toml --json finding.json
    """
    from workbench.diagnosis import diagnose as run
    from workbench.effects import load_model
    from workbench.report import trace_sheet

    to = Outputs(json, html, mcap, rerun, force, quiet)
    to.check(shape, trace)
    loaded = load_model(model)
    data = open_pair(recordings, holdout, whole=whole)
    to.keep(files_of(loaded, [*data.training, *data.held_out]), shape, trace)
    with progress(quiet) as tell:
        result = run(loaded, data.training, data.held_out, seed=seed, progress=staged(tell))
    used = [*data.training, *data.held_out]
    problems = () if result.verdict == "consistent" else data_problems(loaded, used)
    result = replace(result, used=data.share, notes=(*problems, *result.notes, *data.notes))
    files, seeds = files_of(loaded, used), {"noise": seed}
    deliver(result, to, files=files, seeds=seeds)
    if trace is not None:
        deliver_sheet(trace_sheet(result), trace, files=files, seeds=seeds, force=force)
    if shape is not None:
        _draw(result, shape, to)


def _draw(result: Diagnosis, path: str, to: Outputs) -> None:
    from workbench.report import save_figure, shape_figure

    if result.shapes:
        save_figure(shape_figure(result), path, force=to.force)
    elif to.printed:
        typer.echo("No shape was drawn: the unexplained torque has no smooth part.")
