"""Evaluates a bundle on virtual hardware, with the log of a real test, and in the world of its training."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from workbench.bundle import Policy, PolicyBundle
from workbench.core import InputError, Recording
from workbench.models import Model
from workbench.rigs import Sensors

from .draws import Draws
from .machine import Machine, make_machine
from .of_bundle import machine_of, task_of
from .plant import Plant
from .plants import TrainedPlant
from .robot import IDEAL, Robot
from .rollout import PolicyPilot, Push, run
from .task import Task
from .tried import called


@dataclass(frozen=True)
class Evaluation:
    """Result of an evaluation.

    Attributes:
        recording: the log; rows every control step, the first `HOLD_S` seconds without the policy.
        scores: numbers of the task by name.
        fell_s: when it fell, counted from the policy's start [s]; None if it did not.
    """

    recording: Recording
    scores: dict[str, float]
    fell_s: float | None


def evaluate(
    bundle: PolicyBundle,
    *,
    seconds: float = 4.0,
    seed: int = 0,
    hardware: bool = True,
    sensors: Sensors | None = None,
    robot: Robot = IDEAL,
    model: Model | None = None,
    variant: str | None = None,
    world: Callable[[Machine], mujoco.MjModel] | None = None,
    task_file: Path | None = None,
    push: Push | None = None,
    tell: Callable[[float], None] = lambda done: None,
) -> Evaluation:
    """Run the policy of a bundle, and return its scores and recording.

    Args:
        bundle: the policy.
        seconds: how long, after the hold.
        seed: of the command (``reach``) and of the sensors' noise.
        hardware: on the closed chain in Drake; else in the serial machine that it was trained in.
        sensors: of the drives; by default those of the virtual leg.
        robot: what the hardware has beyond its drawing.
        model: of a leg, with its variant; the simulation is of this model instead of the trained one.
        variant: of S3N in place of that of `model`, or ``explicit``.
        world: makes the simulation of a machine, instead of that of its file.
        task_file: the Python file of a task that is one.
        push: pushes on the trunk, on hardware and in simulation alike.
        tell: is told the share that is done.

    Raises:
        InputError: the bundle cannot be run here, or hardware and simulation are asked for at once.
    """
    if (robot is not IDEAL) if not hardware else (model or world) is not None:
        raise InputError(
            "deviations of a robot apply to hardware only, another model and world to simulation only",
            remedy="leave out the options of the other",
        )
    with tempfile.TemporaryDirectory() as folder:
        machine = machine_of(bundle, Path(folder), task_file)
        if hardware:
            plant: Plant = robot.plant(machine)
        else:
            simulated = machine if model is None else make_machine(machine.kind, model, variant)
            plant = TrainedPlant(simulated, None if world is None else world(simulated))
    task = task_of(bundle, task_file)
    log = run(
        PolicyPilot(Policy(bundle), task, machine), machine, plant, seconds, seed,
        command=_command(task, seed, machine), goal=task.goal, sensors=sensors, robot=robot, push=push,
        tell=tell,
    )  # fmt: skip
    variant = bundle.variant if machine.map is None else "fitted"
    name = f"{task.name}_{variant}_{'hardware' if hardware else 'simulation'}"
    stepped = machine.floating and not hardware and world is None
    scores = called("scores", task_file, task.scores, log) if task_file else task.scores(log)
    return Evaluation(log.recording(name, machine, stepped), scores, log.fell_s)


def _command(task: Task, seed: int, machine: Machine) -> np.ndarray:
    if task.trial is not None:
        return task.trial(machine)
    return task.command(Draws(np, seed, np.zeros(1)), 1, machine)
