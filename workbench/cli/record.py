"""``workbench record``."""

from __future__ import annotations

from typing import Annotated

import typer

from workbench.core import InputError

from .add import parse_place, parse_values
from .app import app
from .common import ForceOption, QuietOption


@app.command()
def record(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="The rig: 'leg', the virtual parallel leg.")],
    experiments: Annotated[
        list[str] | None,
        typer.Argument(metavar="EXPERIMENT...", help="Which of its experiments; all where none is named."),
    ] = None,
    output: Annotated[
        str, typer.Option("--output", "-o", metavar="FOLDER", help="Folder for the recordings.")
    ] = "",
    hide: Annotated[
        str | None,
        typer.Option("--hide", metavar="EFFECT[@AXIS]", help="Hide an effect in the virtual hardware."),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="name=value", help="Parameter of the hidden effect; may be given again."
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the sensors' noise.")] = 0,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Run experiments on a rig and write the recordings.

    Example: workbench record leg slow validation -o data --hide coulomb_friction@knee --set torque=0.25
    """
    from workbench.rigs import HiddenEffect, VirtualLeg, demo_experiments

    if rig != "leg":
        raise InputError(f"no rig is called '{rig}'", remedy="the built-in rig is 'leg'")
    if not output:
        raise InputError("no output folder", remedy="say where the recordings go: -o FOLDER")
    known = {e.name: e for e in demo_experiments(seed)}
    for name in experiments or []:
        if name not in known:
            raise InputError(f"no experiment is called '{name}'", remedy=f"choose from {', '.join(known)}")
    chosen = [known[name] for name in (experiments or known)]
    hidden = []
    if hide:
        key = parse_place(hide)
        numbers = {k: v.value for k, v in parse_values(set_ or []).items()}
        hidden = [HiddenEffect(key.effect, key.axis, key.location, numbers)]
    elif set_:
        raise InputError(
            "--set without --hide", remedy="name the effect to hide, e.g. --hide viscous_damping@hip"
        )
    files = VirtualLeg(hidden, seed=seed).record_to(output, chosen, force=force)
    if not quiet:
        typer.echo(f"Wrote {len(files)} recordings to {output}.")
