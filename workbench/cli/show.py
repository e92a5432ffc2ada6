"""``workbench show``."""

from __future__ import annotations

import shlex
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from typer import Argument, Option

from workbench.core import InputError

from . import complete, options
from .common import check_outputs, wrote
from .progress import progress
from .scores import told_scores, trained_in

if TYPE_CHECKING:
    from workbench.core import Recording
    from workbench.report.motion import Panel
    from workbench.simulation.scene import Scene


def show(
    shown: Annotated[
        str, Argument(metavar="BUNDLE|RECORDING", help="A policy bundle (.zip), or a recording (.toml).")
    ],
    output: Annotated[
        str, options.written("--output", "-o", metavar="PAGE", help="The page (.html).  [required]")
    ] = "",
    model: Annotated[
        str | None,
        Option(
            metavar="MODEL", help="For a recording: the model of its machine.", autocompletion=complete.models
        ),
    ] = None,
    seconds: Annotated[float, Option(min=1.5, max=60.0, help="For a bundle: length of the run.")] = 4.0,
    task: Annotated[
        str | None, Option(metavar="FILE", help="For a bundle: the task file, if it is Python.")
    ] = None,
    mp4: Annotated[
        str | None,
        options.written(format_="film", metavar="FILE", help="Write a film as well (.mp4); needs ffmpeg."),
    ] = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Write a page that shows the robot moving beside its curves; a bundle runs in its training
    simulation.

    Example: workbench show runs/reach/bundle.zip -o reach.html

    Example: workbench show data/slow.toml --model leg -o slow.html
    """
    from workbench.core.files import write_whole
    from workbench.report.motion import film, motion_page

    if not output:
        raise InputError("no file for the page", remedy="name one: -o page.html")
    check_outputs(output, mp4, force=force)
    with progress(quiet):
        if shown.endswith(".zip"):
            title, lines, scene, panels = _of_bundle(Path(shown), seconds, Path(task) if task else None)
        else:
            title, lines, scene, panels = _of_recording(Path(shown), model)
        command = shlex.join(["workbench", *sys.argv[1:]])
        page = motion_page(title, lines, scene.time, scene.ends, panels, command, [shown])
        if mp4:  # first: where there is no ffmpeg, nothing is written
            film(Path(mp4), scene.time, scene.ends, force=force)
        write_whole(output, page, force=force)
    if not quiet:
        wrote(f"Wrote {output}{f' and {mp4}' if mp4 else ''}.")


def _of_bundle(file: Path, seconds: float, task: Path | None) -> tuple[str, list[str], Scene, list[Panel]]:
    from workbench.bundle import read_bundle
    from workbench.report.motion import Panel
    from workbench.simulation.scene import scene_of
    from workbench.training.curve_file import read_curve
    from workbench.training.evaluate import evaluate
    from workbench.training.of_bundle import machine_of

    bundle = read_bundle(file)
    with tempfile.TemporaryDirectory() as folder:
        machine = machine_of(bundle, Path(folder), task)
        done = evaluate(bundle, seconds=seconds, hardware=False, task_file=task)
        r = done.recording
        motion = [machine.joint_motion(*row) for row in zip(r.position, r.signals["velocity"], strict=True)]
        joints = np.array([q for q, _ in motion])
        qpos = np.tile(machine.mujoco.qpos0, (len(joints), 1))
        qpos[:, machine.places] = joints
        if machine.floating:
            qpos[:, :7] = np.hstack([r.extra["base_position"], r.extra["base_orientation"]])
        scene = scene_of(machine.mujoco, r.time, qpos)
    panels = _signals(r)
    curve = read_curve(file.parent) if file.parent.joinpath("config.json").is_file() else []
    if curve:
        over = np.array([row["iteration"] for row in curve])
        values = {"reward per second": np.array([row.get("reward", np.nan) for row in curve])}
        panels.append(Panel("Learning", "iteration", over, values, moves=False))
    scores = "; ".join(
        f"{name} {value:.4g} {unit}".rstrip() for name, unit, value in told_scores(done.scores)
    )
    fell = "" if done.fell_s is None else f" It fell after {done.fell_s:.2f} s."
    lines = [f"Trained in {trained_in(bundle)}; here it runs in the same simulation. Scores: {scores}.{fell}"]
    return f"{bundle.task} ({file.name})", lines, scene, panels


def _of_recording(file: Path, model: str | None) -> tuple[str, list[str], Scene, list[Panel]]:
    from workbench.effects import load_model
    from workbench.recordings import load_recordings
    from workbench.simulation.scene import scene_of_recording

    if model is None:
        raise InputError("no model", file=file, remedy="say which machine it is of: --model MODEL")
    (recording,) = load_recordings([file])
    scene = scene_of_recording(recording, load_model(model))
    return (
        recording.name,
        [f"A recording of {len(recording)} rows, {recording.time[-1] - recording.time[0]:.3g} s."],
        scene,
        _signals(recording),
    )


def _signals(r: Recording) -> list[Panel]:
    """Positions beside their references, speeds and torques, an axis after the other."""
    from workbench.report.motion import Panel

    time, panels = r.time - r.time[0], []
    torques = [name for name in ("torque_command", "torque_measured") if name in r.signals]
    same = r.controller.coordinates == "actuator" or r.coordinates == "joint"
    for k, axis in enumerate(r.axes):
        own = {"position": r.position[:, k]}
        if same and "position_reference" in r.signals:
            own["reference"] = r.signals["position_reference"][:, k]
        panels.append(Panel(f"{axis}: position [{r.units[k]}]", "time [s]", time, own))
        if torques:
            values = {name.replace("_", " "): r.signals[name][:, k] for name in torques}
            unit = "N" if r.units[k] == "m" else "N m"
            panels.append(Panel(f"{axis}: torque [{unit}]", "time [s]", time, values))
    return panels
