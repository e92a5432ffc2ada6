"""``workbench export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer import Argument

from workbench.core import InputError

from . import options
from .common import check_outputs, write_result, wrote


def export(
    run: Annotated[str, Argument(metavar="RUN", help="Folder of a run of `workbench train`.")],
    output: Annotated[
        str,
        options.written(
            "--output", "-o", ending=".zip", metavar="BUNDLE", help="The new .zip file.  [required]"
        ),
    ] = "",
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Write the policy of a run's last checkpoint as a bundle: ONNX, layout, gains, limits, model, record.

    Example: workbench export runs/reach -o reach.zip
    """
    if not output:
        raise InputError("no output file", remedy="say where the bundle goes: -o reach.zip")
    try:
        from workbench.training.export import export as write
        from workbench.training.folder import CHECKPOINT, CONFIG
    except ImportError as error:
        raise InputError(
            f"export needs {error.name}",
            remedy="install the extra: pip install 'robot-workbench[training]'",
        ) from error
    check_outputs(output, json, force=force)
    path = write(run, output, force=force)
    if json:
        files = [Path(run) / name for name in (CONFIG, CHECKPOINT)]
        write_result({"format": 1, "run": run, **bundle_dict(path)}, json, files=files, force=force)
    if not quiet and json != "-":
        wrote(f"Wrote {path}.")


def bundle_dict(path: Path) -> dict[str, Any]:
    """What a bundle says of itself, for programs."""
    from workbench.bundle import read_bundle

    bundle = read_bundle(path)
    training = bundle.manifest["training"]
    return {
        "bundle": str(path),
        "task": bundle.task,
        "variant": bundle.variant,
        "joints": list(bundle.control.joints),
        "iterations": training["iterations"],
        "onnx_against_torch": training["onnx_against_torch"],
        "verified": bundle.verified,
    }
