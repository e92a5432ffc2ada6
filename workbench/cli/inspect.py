"""``workbench inspect``."""

from __future__ import annotations

import typer

from . import options
from .common import check_outputs, files_of, read_recordings, write_result


def inspect(
    recordings: options.Recordings,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Check recordings for swapped axes, wrong signs, units, gains, clocks and noise.

    Exit code 1 where something is wrong with them or may be: at a problem or a warning, not at a note.

    Example: workbench inspect recordings/*.toml
    """
    from workbench import report
    from workbench.inspection import inspect as run
    from workbench.inspection import inspection_dict

    from .inspect_table import inspection_table

    check_outputs(json, force=force)
    data = read_recordings(recordings)
    result = run(data)
    if json:
        write_result(inspection_dict(result), json, files=files_of(None, data), force=force)
    if not quiet and json != "-":
        report.print_table(inspection_table(result))
    if not result.sound:
        raise typer.Exit(1)
