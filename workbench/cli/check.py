"""``workbench check``."""

from __future__ import annotations

from typing import Annotated

import typer
from typer import Option

from . import options
from .common import check_outputs, files_of, write_result
from .deliver import deliver_sheet
from .progress import progress


def check(
    model: options.Model,
    json: options.Json = None,
    html: options.Html = None,
    samples: Annotated[int, Option(min=3, max=100_000, help="Number of random postures and speeds.")] = 50,
    seed: Annotated[int, Option(min=0, help="Seed of the random postures and speeds.")] = 0,
    tolerance: Annotated[
        float, Option(min=0.0, help="Relative difference allowed between [linkage] and the closed chain.")
    ] = 1e-9,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Compare the serial tree, the closed chain and every S3N variant; exit with 1 if they disagree.

    Drake, Pinocchio, MuJoCo and the closed forms of the method are compared over random postures and speeds.

    Example: workbench check leg --json check.json
    """
    from workbench import report
    from workbench.models import read_model
    from workbench.verification import verify

    check_outputs(json, html, force=force)
    loaded = read_model(model)
    with progress(quiet) as tell:
        tell("comparing engines over random postures")
        result = verify(loaded, samples=samples, seed=seed, tolerance=tolerance)
    if not quiet and json != "-":
        report.print_table(report.verification_table(result))
    if json:
        content, seeds = report.verification_dict(result), {"postures": seed}
        write_result(content, json, files=files_of(loaded), seeds=seeds, force=force)
    if html:
        sheet = report.verification_sheet(result)
        deliver_sheet(sheet, html, files=files_of(loaded), seeds={"postures": seed}, force=force)
    if not result.passed:
        raise typer.Exit(1)
