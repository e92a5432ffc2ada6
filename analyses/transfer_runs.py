"""Runs on the virtual quadruped and in simulators, each computed once: a folder keeps them.

A run is known by its policy, model, options and all of the package's source, so that none outlives a change.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import joblib
from transfer_jump import jump
from transfer_robot import IDEAL, Robot, RobotPlant
from transfer_worlds import EVALUATION, Law, Push, world_of

import workbench
from workbench.bundle import read_bundle
from workbench.core import Recording
from workbench.models import read_model
from workbench.rigs import PERFECT
from workbench.training.evaluate import evaluate
from workbench.training.machine import make_machine
from workbench.training.plants import TrainedPlant

_SIMULATION_SEED = 10_000  # of the inertial unit's noise, which no other run draws


@dataclass(frozen=True)
class Job:
    """One run: of a policy, or the scripted jump where there is none.

    Attributes:
        seconds: after the hold.
        seed: of the noise.
        policy: bundle.
        model: of the leg that the simulation has; None: on the hardware.
        variant: of S3N that is simulated; None: the model's.
        robot: the hardware; a simulation has its payload.
        law: of a simulation's contacts.
        height: of a jump.
        push: on the trunk.
        task: file of the policy's task, where it is Python.
    """

    seconds: float
    seed: int
    policy: Path | None = None
    model: Path | None = None
    robot: Robot = IDEAL
    law: Law = EVALUATION
    height: float = 1.0
    push: Push | None = None
    task: Path | None = None
    variant: str | None = None


@dataclass(frozen=True)
class Made:
    """What a run gave: its recording, when it fell, and of a jump apex [m] and take-off speed [m/s]."""

    recording: Recording
    fell_s: float | None
    apex: float = 0.0
    take_off: float = 0.0


@dataclass(frozen=True)
class Kept:
    """Runs jobs and keeps what they give.

    Args:
        folder: of the runs.
    """

    folder: Path

    def __call__(self, job: Job) -> Made:
        """The run, from the folder where it is there."""
        file = self.folder / f"{_key(job)}.joblib"
        if file.exists():
            return joblib.load(file)
        made = _run(job)
        part = file.with_suffix(f".{os.getpid()}.part")  # another process may be at the same run
        file.parent.mkdir(parents=True, exist_ok=True)
        joblib.dump(made, part, compress=3)
        part.replace(file)
        return made


def _key(job: Job) -> str:
    files = [_digest(file) for file in (job.policy, job.model, job.task) if file is not None]
    plain = replace(job, policy=None, model=None, task=None)
    told: Any = (_source(), *files, job.model is None, repr(plain))
    return hashlib.sha256(repr(told).encode()).hexdigest()[:24]


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


@cache
def _source() -> str:
    """Of all of the package's code, and of what the study's runs are made of."""
    whole, own = hashlib.sha256(), Path(__file__).parent.glob("transfer_[djrw]*.py")
    for file in sorted([*Path(workbench.__file__).parent.rglob("*.py"), *own]):
        whole.update(file.read_bytes())
    return whole.hexdigest()


def _run(job: Job) -> Made:
    if job.policy is None:
        return _jump(job)
    bundle = read_bundle(job.policy)
    push = None if job.push is None else job.push.at
    both: dict[str, Any] = {"seconds": job.seconds, "push": push, "task_file": job.task}
    if job.model is None:
        made = evaluate(bundle, seed=job.seed, robot=job.robot, **both)
    else:
        made = evaluate(
            bundle, seed=_SIMULATION_SEED, hardware=False, sensors=PERFECT, model=read_model(job.model),
            variant=job.variant,
            world=partial(world_of, law=job.law, payload=job.robot.payload), **both,
        )  # fmt: skip
    return Made(made.recording, made.fell_s)


def _jump(job: Job) -> Made:
    own = read_model(job.model or "leg_s3n_full")
    machine = make_machine("quadruped", own)
    payload = job.robot.payload
    if job.model is None:
        plant, robot, sensors = RobotPlant(machine, job.robot), job.robot, None
    else:
        plant, robot, sensors = TrainedPlant(machine, world_of(machine, job.law, payload)), IDEAL, PERFECT
    made, log = jump(machine, plant, height=job.height, seed=job.seed, sensors=sensors, robot=robot)
    return Made(log.recording("jump", machine, False), log.fell_s, made.apex, made.take_off)
