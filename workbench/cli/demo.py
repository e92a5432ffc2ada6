"""``workbench demo``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from . import complete, options
from .common import check_outputs, files_of
from .deliver import Outputs, deliver
from .hidden import HideOption, SetOption
from .progress import progress, staged

if TYPE_CHECKING:
    from workbench.core import Improvement


def demo(
    output: Annotated[
        str,
        Argument(
            metavar="FOLDER|MODEL",
            help="Folder for all results; or a model of your own, with -o for the folder.",
            autocompletion=complete.models,
        ),
    ] = "demo",
    experiments: Annotated[
        list[str] | None,
        Argument(metavar="DESIGN...", help="For a model of your own: the experiments you plan."),
    ] = None,
    folder_of_model: Annotated[
        str,
        options.written(
            "--output",
            "-o",
            folder=True,
            metavar="FOLDER",
            help="For a model of your own: the folder for all results.",
        ),
    ] = "demo",
    hide: HideOption = None,
    set_: SetOption = None,
    seed: Annotated[int, Option(min=0, help="Seed of the hidden effect, its size and all noise.")] = 0,
    clean: Annotated[
        bool, Option("--clean", help="Hide nothing; the right answer is then that nothing is missing.")
    ] = False,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Hide an effect in virtual hardware, record it, find the effect, add it, and then reveal the truth.

    The hardware is the reference leg, or a model of your own with the experiments that you plan.

    Example: workbench demo demo --seed 7

    Example: workbench demo my_leg.toml chirp.toml -o out --hide coulomb_friction@knee --set torque=0.3
    """
    from workbench.core import InputError
    from workbench.core.files import together
    from workbench.diagnosis import improve
    from workbench.effects import load_model
    from workbench.models import write_model
    from workbench.recordings import load_recordings
    from workbench.rigs import VirtualLeg, demo_experiments, draw_hidden

    from .record_own import is_model

    own = is_model(output)
    if not own and (experiments or hide or set_):
        raise InputError(
            f"'{output}' is not a model; experiments and effects need one",
            remedy="give a model, by its file or name: workbench demo MODEL DESIGN... -o FOLDER",
        )
    folder = Path(options.placed_folder(folder_of_model if own else output))
    if folder.exists() and not force and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError("the folder is not empty", file=folder, remedy="choose another one or add --force")
    check_outputs(json, force=force)
    say = (lambda text: None) if quiet or json == "-" else typer.echo
    if own:
        from .demo_own import record_hidden

        asked = (hide, set_)
        model, names, effects = record_hidden(
            output, experiments or [], folder, asked, (seed, clean, force), say
        )
        truth = [{**vars(h), "parameters": dict(h.parameters)} for h in effects]
        held_out = names[-1:] if len(names) > 1 else []
    else:
        hidden = () if clean else (draw_hidden(seed),)
        say("A virtual parallel leg, the reference leg, with something hidden in it is recorded: two chirps,")
        say("two multisines, a slow sweep, and a validation motion that is held out for testing.")
        files = VirtualLeg(hidden, seed=seed).record_to(
            folder / "recordings", demo_experiments(seed), force=force
        )
        names, model = [str(f) for f in files], load_model("leg")
        held_out = [n for n in names if Path(n).stem == "validation"]
        truth = [
            {"effect": h.effect, "axis": h.axis, "location": h.key.location, "parameters": dict(h.parameters)}
            for h in hidden
        ]
    training = load_recordings([n for n in names if n not in held_out])
    judging = load_recordings(held_out)
    with progress(quiet) as tell:
        result, better = improve(model, training, judging, seed=seed, progress=staged(tell))
    page = str(folder / "report.html")
    files, to = files_of(model, [*training, *judging]), Outputs(json, page, force=force, quiet=quiet)
    with together():
        if result.added:
            write_model(replace(better, name=f"{model.name}_improved"), folder / "improved.toml", force=force)
        deliver(result, to, files=files, seeds={"demo": seed}, truth=truth)
        _draw_figures(result, folder, force=force)
    made = "recordings, figures and improved.toml" if result.added else "recordings and figures"
    say(f"\nOpen {page} in a browser; {made} are in the same folder.")


def _draw_figures(result: Improvement, folder: Path, *, force: bool) -> None:
    """Error falling, residuals and spectra before and after, and curves over curves, as PNG."""
    from workbench import report

    if result.before is None:
        return
    report.save_figure(report.ladder_figure(result), folder / "error_falling.png", force=force)
    after = result.after if result.steps else None
    worst = result.steps[0].key.axis if result.steps else None
    axis = worst or result.before.axes[0]
    for name, draw in (
        ("overlay", report.overlay_figure),
        ("residual", report.residual_figure),
        ("spectrum", report.spectrum_figure),
    ):
        report.save_figure(draw(result.before, axis, after=after), folder / f"{name}_{axis}.png", force=force)
