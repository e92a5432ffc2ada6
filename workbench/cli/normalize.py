"""``workbench normalize``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Option

from workbench.core import InputError, WorkbenchError

from . import complete, options
from .common import check_outputs, echo, files_of, write_result, wrote
from .progress import progress

if TYPE_CHECKING:
    from workbench.s3n.targets import Fitted


def normalize(
    model: options.Model,
    output: Annotated[
        str, options.written("--output", "-o", metavar="FILE", help="The new MJCF file.  [required]")
    ] = "",
    variant: Annotated[
        str | None,
        Option(
            metavar="NAME",
            help="kin_only, s3n_act, s3n_full or exact; default: the model's, or S3N-Full for Kin-Only.",
            autocompletion=complete.variants,
        ),
    ] = None,
    allow_error: Annotated[
        float,
        Option(
            min=0.0,
            help="If the transmission depends on the posture: largest error allowed for the fitted inertia.",
        ),
    ] = 0.05,
    for_: Annotated[
        str,
        Option(
            "--for",
            metavar="TARGET",
            help="Target program: mujoco (4), mujoco3, mjlab, newton or urdf; all losses are listed.",
            autocompletion=complete.targets,
        ),
    ] = "mujoco",
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Write the S3N-normalised serial tree as plain MJCF, for any training pipeline.

    Without --variant, a Kin-Only model that states its linkage is written as S3N-Full. A mechanism whose
    transmission depends on the posture is fitted over its limits; the file states the remaining error.

    Example: workbench normalize leg -o leg.xml --variant s3n_full

    Example: workbench normalize leg -o leg.urdf --for urdf
    """
    from workbench import report
    from workbench.core.files import write_all
    from workbench.effects import load_model
    from workbench.s3n import floating_base_error, normalise, omissions, usual_variant, write_normalised
    from workbench.s3n.posture_fitted import FittedTree, fit_native
    from workbench.s3n.targets import for_target

    from .normalize_table import normalize_table

    if not output:
        raise InputError("no output file", remedy="say where the MJCF goes: -o leg.xml")
    check_outputs(output, json, force=force)
    loaded = load_model(model)
    if loaded.posture_dependent and variant is None:
        with progress(quiet) as tell:
            tell("fitting the tree over the workspace")
            tree = fit_native(loaded, allow=allow_error)
    else:
        variant = variant or usual_variant(loaded)
        tree = normalise(loaded, variant)
    base, unknown = None, "the model names no closed chain"
    if loaded.closed_chain is not None and not isinstance(tree, FittedTree):
        try:
            base = floating_base_error(loaded, variant)
        except WorkbenchError as error:  # the file is right on its fixed base all the same
            unknown = str(error)
    fitted = for_target(tree.xml, for_)
    if for_ == "urdf":
        write_all({Path(output): fitted.text}, force=force)
    else:
        write_normalised(replace(tree, xml=fitted.text), output, force=force)
    if json:
        content: dict[str, Any] = {
            "format": 1,
            "model": loaded.name,
            "variant": tree.model.variant,
            "file": output,
            "added": [vars(entry) for entry in tree.added],
            "left_out": list(tree.left_out),
            "variant_leaves_out": [] if isinstance(tree, FittedTree) else list(omissions(tree.model)),
            "removed": list(tree.removed),
            "floating_base": None
            if base is None
            else {name: value for name, value in vars(base).items() if name != "postures"},
        }
        content["for"] = {"target": for_, "lost": list(fitted.lost), "reads": fitted.reads}
        if isinstance(tree, FittedTree):
            content["fitted"] = {**vars(tree.error), "offsets": tree.offsets.tolist()}
        write_result(content, json, files=files_of(loaded), force=force)
    if not quiet and json != "-":
        report.print_table(normalize_table(tree, base, unknown))
        for line in _told(for_, fitted):
            echo(line)
        wrote(f"Wrote {output}.")


def _told(target: str, fitted: Fitted) -> list[str]:
    """What a target keeps and loses, in lines; nothing where the file is MuJoCo's own."""
    if target == "mujoco":
        return []
    lost = [f"  {each}" for each in fitted.lost]
    head = f"For {target} ({fitted.reads})"
    return [f"{head} this is lost:" if lost else f"{head} nothing is lost.", *lost, *fitted.advice]
