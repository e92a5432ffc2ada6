"""``workbench compare``."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer
from typer import Option

from workbench.core import InputError, SimulationError

from . import options
from .common import echo, files_of, open_sources
from .compare_gait import compare_gait
from .deliver import Outputs, deliver
from .progress import progress


def compare(
    model: options.Model,
    recordings: options.Recordings,
    json: options.Json = None,
    html: options.Html = None,
    mcap: options.Mcap = None,
    rerun: options.Rerun = None,
    fail_above: Annotated[
        float | None, Option(min=0.0, metavar="ERROR", help="Exit with 1 if the error is larger than this.")
    ] = None,
    gait: Annotated[
        str | None,
        Option(
            metavar="SIM",
            help="Compare the gait: REC comes from hardware, SIM from a simulator that ran the same command.",
        ),
    ] = None,
    again: Annotated[
        str | None,
        Option(metavar="REC", help="With --gait: a second run of the hardware, which gives the noise floor."),
    ] = None,
    command: Annotated[
        str | None,
        Option(
            metavar="V,W",
            help="With --gait: commanded speed [m/s] and yaw rate [rad/s]; default: the hardware's means.",
        ),
    ] = None,
    start: Annotated[
        float,
        Option(
            "--from", min=0.0, metavar="SECONDS", help="With --gait: leave out all rows before this time."
        ),
    ] = 0.0,
    seed: options.Seed = 0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Run the model the way each recording was made, and report its error beside the noise floor.

    With --gait, of a robot that walks: strides, cycles, E_phi, and the prediction of the swing leg.

    Example: workbench compare leg recordings/chirp_hip.toml --html report.html
    """
    if gait is not None:
        if html is not None or mcap is not None or rerun is not None or fail_above is not None:
            raise InputError(
                "--gait makes a table and JSON", remedy="omit --html, --mcap, --rerun and --fail-above"
            )
        compare_gait(model, recordings, gait, again, command, start, json, force, quiet)
        return
    if again is not None or command is not None or start:
        raise InputError(
            "--again, --command and --from belong to --gait",
            remedy="name the simulator's recording: --gait SIM",
        )
    from workbench.comparison import compare_logs
    from workbench.diagnosis import doubts
    from workbench.effects import load_model

    to = Outputs(json, html, mcap, rerun, force, quiet)
    to.check()
    loaded, data = load_model(model), open_sources(recordings)
    to.keep(files_of(loaded, data))
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
    deliver(result, to, files=files_of(loaded, data), seeds={"noise": seed})
    if fail_above is not None and not result.error <= fail_above:
        raise typer.Exit(1)
