"""``workbench export``."""

from __future__ import annotations

from typing import Annotated

import typer

from workbench.core import InputError

from .app import app
from .common import ForceOption, QuietOption, echo


@app.command()
def export(
    run: Annotated[str, typer.Argument(metavar="RUN", help="Folder of a run of `workbench train`.")],
    output: Annotated[str, typer.Option("--output", "-o", metavar="BUNDLE", help="The new .zip file.")] = "",
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the policy of a run's last checkpoint as a bundle: ONNX, layout, gains, limits, model, record.

    Example: workbench export runs/reach -o reach.zip
    """
    if not output:
        raise InputError("no output file", remedy="say where the bundle goes: -o reach.zip")
    try:
        from workbench.training.export import export as write
    except ImportError as error:
        raise InputError(
            f"export needs {error.name}", remedy="install the extra: pip install 'workbench[training]'"
        ) from error
    path = write(run, output, force=force)
    if not quiet:
        echo(f"Wrote {path}.")
