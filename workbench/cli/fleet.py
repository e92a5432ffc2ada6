"""``workbench fleet``."""

from __future__ import annotations

from typing import Annotated

import typer
from typer import Argument, Option

from workbench.core.text import counted

from . import options
from .common import check_outputs, write_result
from .deliver import deliver_sheet
from .progress import progress


def fleet(
    recordings: Annotated[
        list[str],
        Argument(metavar="REC...", help="Recordings, patterns or folders, of any number of robots."),
    ],
    model: Annotated[
        list[str],
        Option(
            metavar="[RIG=]MODEL",
            help="Model of all robots, or of rigs that match a pattern; or a folder of RIG.toml files.",
        ),
    ],
    output: Annotated[
        str,
        options.written(
            "--output",
            "-o",
            folder=True,
            metavar="FOLDER",
            help="Folder for results and improved models, one per robot.",
        ),
    ],
    holdout: Annotated[
        list[str] | None,
        Option(
            metavar="PATTERN",
            help="Names of recordings that only test; default: one in four of each robot with three or more.",
        ),
    ] = None,
    jobs: Annotated[
        int, Option("--jobs", "-j", metavar="N", help="Robots diagnosed in parallel; -1: one per core.")
    ] = -1,
    ray: Annotated[
        str | None,
        Option(metavar="ADDRESS", help="Run on this Ray cluster; 'auto': the one that is running."),
    ] = None,
    json: options.Json = None,
    html: options.Html = None,
    seed: options.Seed = 0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Diagnose each of many robots from its own logs, and say where the robots differ.

    Each result is written to FOLDER at once; if the command was stopped, the same command continues. Exit
    code 1 if a robot could not be diagnosed.

    Example: workbench fleet logs --model leg -o found --html fleet.html

    Example: workbench fleet 'logs/**/*.toml' --model 'leg-*=leg' --model 'arm-*=arms' -o found --jobs 8
    """
    from workbench import report
    from workbench.core.files import together
    from workbench.fleet import (
        files_read,
        find_robots,
        fleet_dict,
        fleet_sheet,
        fleet_table,
        run_fleet,
        summarise,
    )

    check_outputs(json, html, force=force)
    robots = find_robots(recordings, model, holdout)
    with progress(quiet) as tell:
        tell(f"diagnosing {counted(len(robots), 'robot')}")
        told = run_fleet(robots, output, seed=seed, jobs=jobs, ray=ray, force=force, progress=tell)
    found = summarise(told)
    files = files_read(robots)
    if not quiet and json != "-":
        report.print_table(fleet_table(found))
    with together():
        if json:
            write_result(fleet_dict(found), json, files=files, seeds={"noise": seed}, force=force)
        if html:
            deliver_sheet(fleet_sheet(found), html, files=files, seeds={"noise": seed}, force=force)
    if found.failed:
        raise typer.Exit(1)
