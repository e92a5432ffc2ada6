"""``workbench approve``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import options
from .common import check_outputs, echo, files_of, read_recordings, write_result, wrote
from .progress import progress


def approve(
    model: options.Model,
    recordings: options.Recordings,
    output: Annotated[
        str | None,
        options.written(
            "--output", "-o", metavar="FILE", help="The new record; default: beside the model's file."
        ),
    ] = None,
    json: options.Json = None,
    seed: options.Seed = 0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Check a model, compare it with recordings, and write the record of both that `train` requires.

    Exit code 1 if a check failed or the error is above the noise; the record states this, and train refuses
    it.

    Example: workbench approve leg.toml recordings/*.toml
    """
    from workbench.effects import load_model
    from workbench.training.record import make_record, objections, record_path, summary, write_record

    loaded, data = load_model(model), read_recordings(recordings)
    path = Path(output) if output else record_path(loaded)
    check_outputs(str(path), json, force=force)
    with progress(quiet) as tell:
        tell("checking the model and comparing it with the recordings")
        record = make_record(loaded, data, seed=seed)
    write_record(record, path, force=force)
    against = objections(record, loaded, loaded.variant)
    if json:
        # the record names versions and hashes itself; here they stand where every result has them
        known = {key: value for key, value in record.items() if key not in ("files", "versions")}
        content = {**known, "approved": not against, "objections": against, "file": str(path)}
        seeds = {"postures": seed, "noise": seed}
        write_result(content, json, files=files_of(loaded, data), seeds=seeds, force=force)
    if not quiet and json != "-":
        echo(f"{summary(record)}.")
        for line in against:
            echo(f"Not approved: {line}.")
        wrote(f"Wrote {path}.")
    if against:
        raise typer.Exit(1)
