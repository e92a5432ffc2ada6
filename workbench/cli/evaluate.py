"""``workbench evaluate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option

from workbench.core import InputError

from . import options
from .common import check_outputs, echo, write_result, wrote
from .progress import progress
from .scores import score_words, trained_in


def evaluate(
    bundle: Annotated[str, Argument(metavar="BUNDLE", help="A policy bundle (.zip).")],
    output: Annotated[
        str,
        options.written(
            "--output", "-o", folder=True, metavar="FOLDER", help="Folder for the recordings.  [required]"
        ),
    ] = "",
    seconds: Annotated[float, Option(min=1.5, max=600.0, help="How long it runs.")] = 4.0,
    seed: Annotated[int, Option(min=0, help="Seed of the command and of the sensors' noise.")] = 0,
    task: Annotated[str | None, Option(metavar="FILE", help="The task file, if it is Python.")] = None,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Run a policy on virtual hardware, a closed chain in Drake, and in the simulation it was trained in.

    Both are logged as recordings, which compare reads. Exit code 1 if the robot fell on the hardware.

    Example: workbench evaluate reach.zip -o evaluated
    """
    from workbench.bundle import read_bundle
    from workbench.core.files import write_all
    from workbench.recordings import save_recording
    from workbench.training.evaluate import evaluate as run
    from workbench.training.of_bundle import hardware_of, robot_files

    if not output:
        raise InputError("no folder for the recordings", remedy="name one: -o evaluated")
    loaded, folder = read_bundle(bundle), Path(output)
    files = {name: folder / f"{name}.toml" for name in ("hardware", "simulation")}
    check_outputs(*map(str, files.values()), json, force=force)
    file = Path(task) if task else None
    robot = robot_files(loaded, folder, file)
    check_outputs(*map(str, robot), force=force)
    content: dict[str, Any] = {"format": 1, "bundle": bundle, "task": loaded.task, "variant": loaded.variant}
    content |= {"trained_in": trained_in(loaded), "on": hardware_of(loaded, file)}
    if not quiet and json != "-":
        echo(content["on"])
    with progress(quiet) as tell:
        for name, target in files.items():
            result = run(
                loaded, seconds=seconds, seed=seed, hardware=name == "hardware", task_file=file,
                tell=lambda done, name=name: tell(f"{name}: {100 * done:.0f} %"),
            )  # fmt: skip
            save_recording(result.recording, target, force=force)
            content[name] = {"scores": result.scores, "fell_s": result.fell_s, "recording": str(target)}
    if robot:
        write_all(robot, force=force)
        content["model"] = str(folder / "robot.toml")
    if json:
        write_result(content, json, files=[Path(bundle)], seeds={"run": seed}, force=force)
    if not quiet and json != "-":
        echo(f"{loaded.task}, trained in {trained_in(loaded)}:")
        for score in content["hardware"]["scores"] or content["simulation"]["scores"]:
            values = [f"{content[n]['scores'].get(score, float('nan')):8.4f} {n}" for n in files]
            what, unit = score_words(score)
            echo(f"  {f'{what} [{unit}]' if unit else what:32s} {'  '.join(values)}")
        wrote(f"Wrote 2 recordings to {folder}.")
        if robot:
            wrote(
                "Compare them with the simulation that it was trained in: workbench compare "
                f"{folder}/robot.toml"
            )
    fell = content["hardware"]["fell_s"]
    if fell is not None:
        if not quiet and json != "-":
            wrote(f"It fell on the hardware after {fell:.2f} s.")
        raise typer.Exit(1)
