"""``workbench compare``."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

from workbench.core import SimulationError

from .common import (
    ForceOption,
    HtmlOption,
    JsonOption,
    ModelArgument,
    QuietOption,
    RecordingsArgument,
    SeedOption,
    check_outputs,
    deliver,
    echo,
    files_of,
    open_sources,
)
from .progress import progress


def compare(
    model: ModelArgument,
    recordings: RecordingsArgument,
    json: JsonOption = None,
    html: HtmlOption = None,
    fail_above: Annotated[
        float | None,
        typer.Option("--fail-above", metavar="ERROR", help="Exit with 1 if the error is larger than this."),
    ] = None,
    seed: SeedOption = 0,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Run the model the way each recording was made, and say how far it is from it and from the noise.

    Example: workbench compare leg recordings/chirp_hip.toml --html report.html
    """
    from workbench.comparison import compare_logs
    from workbench.diagnosis import doubts
    from workbench.effects import load_model

    check_outputs(json, html, force=force)
    loaded, data = load_model(model), open_sources(recordings)
    with progress(quiet) as tell:
        tell("simulating the recordings, with and without noise")
        try:
            result = compare_logs(loaded, data, seed=seed, progress=tell)
        except SimulationError:
            for line in () if quiet else doubts(loaded, data):
                echo(f"note: {line}", err=True)
            raise
        if not result.consistent:
            result = replace(result, notes=(*doubts(loaded, data), *result.notes))
    deliver(
        result,
        json=json,
        html=html,
        force=force,
        quiet=quiet,
        files=files_of(loaded, data),
        seeds={"noise": seed},
    )
    if fail_above is not None and not result.error <= fail_above:
        raise typer.Exit(1)
