"""``workbench demo``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from .app import app
from .common import ForceOption, JsonOption, QuietOption, check_outputs, deliver, files_of
from .progress import progress, staged


@app.command()
def demo(
    output: Annotated[
        str, typer.Argument(metavar="FOLDER", help="Folder for recordings, model, page and figures.")
    ] = "demo",
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Draws the hidden effect, its size and all noise.")
    ] = 0,
    clean: Annotated[
        bool, typer.Option("--clean", help="Hide nothing: the answer has to be that nothing is missing.")
    ] = False,
    json: JsonOption = None,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Hide an effect in the virtual leg, record it, find the effect, add it, and then reveal the truth.

    Example: workbench demo demo --seed 7
    """
    from workbench.core import InputError
    from workbench.diagnosis import improve
    from workbench.effects import load_model
    from workbench.models import write_model
    from workbench.recordings import load_recordings
    from workbench.rigs import VirtualLeg, demo_experiments, draw_hidden

    from .demo_figures import draw_figures

    folder = Path(output)
    if folder.exists() and not force and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError("the folder is not empty", file=folder, remedy="choose another one or add --force")
    check_outputs(json, force=force)
    say = (lambda text: None) if quiet or json == "-" else typer.echo
    hidden = () if clean else (draw_hidden(seed),)
    say("A virtual parallel leg with something hidden in it is recorded: two chirps, two multisines,")
    say("a slow sweep, and a validation motion that judges.")
    files = VirtualLeg(hidden, seed=seed).record_to(
        folder / "recordings", demo_experiments(seed), force=force
    )
    names = [str(f) for f in files]
    held_out = [n for n in names if Path(n).stem == "validation"]
    training = load_recordings([n for n in names if n not in held_out])
    judging = load_recordings(held_out)
    model = load_model("leg")
    with progress(quiet) as tell:
        result, better = improve(model, training, judging, seed=seed, progress=staged(tell))
    write_model(replace(better, name="leg_improved"), folder / "improved.toml", force=force)
    truth = [
        {"effect": h.effect, "axis": h.axis, "location": h.key.location, "parameters": dict(h.parameters)}
        for h in hidden
    ]
    page = str(folder / "report.html")
    deliver(
        result,
        json=json,
        html=page,
        force=force,
        quiet=quiet,
        files=files_of(model, [*training, *judging]),
        seeds={"demo": seed},
        truth=truth,
    )
    draw_figures(result, folder, force=force)
    say(f"\nLook at {page}; recordings, figures and improved.toml lie beside it.")
