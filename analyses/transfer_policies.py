"""Policies on the virtual quadruped and in simulators that were built from recordings of one of its legs.

Hardware is the closed chain in Drake on its ground, with encoders, noise and delay, and every leg's drives
hide what the measured leg's hide. The simulator of a method is its variant, identified on that leg; the
policies themselves were trained in the same variant with the nominal numbers, from several training seeds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from transfer_identification import find_effects, identify_plant
from transfer_plants import SETS, reference_leg
from transfer_trials import run_trials

from workbench.bundle import read_bundle
from workbench.models import Model, read_model
from workbench.rigs import PERFECT
from workbench.training.evaluate import evaluate
from workbench.training.machine import STEP_S, make_machine

POLICIES = Path(__file__).parents[1] / "policies"
#: Row of the tables -> its policy's file, and the simulator that it is held against.
METHODS = {
    "Kin-Only": ("kin_only", "kin_only"),
    "Kin-Only HR": ("kin_only_hr", "kin_only"),
    "S3N-Act": ("s3n_act", "s3n_act"),
    "S3N-Full": ("s3n_full", "s3n_full"),
    "S3N + found effects": ("s3n_full", "found"),
}
#: Sets with policies that were trained in the simulator with found effects, of recordings of seed 0, by task.
RETRAINED = {"pitch-in-place": ("hidden effects", "no play"), "circular": ("hidden effects",)}
#: Training seeds of the shipped policies, by task.
TRAINED = {"pitch-in-place": 3, "circular": 3}
_SIMULATION_SEED = 10_000  # of the inertial unit's noise, which no other run draws


def methods_of(task: str, which: str) -> dict[str, tuple[str, str]]:
    """`METHODS`, and on a set that has one a policy that was trained with what was found there."""
    if which not in RETRAINED[task]:
        return METHODS
    return METHODS | {"trained with found effects": (f"found_{which.replace(' ', '_')}", "found")}


@dataclass(frozen=True)
class Simulators:
    """Models of one leg by the names of `METHODS`, what was found, and what plain MJCF cannot hold of it."""

    models: dict[str, Model]
    found: tuple[str, ...]
    left_out: tuple[str, ...]

    @property
    def about(self) -> str:
        """The last two in a line."""
        found, left_out = (", ".join(x) or "nothing" for x in (self.found, self.left_out))
        return f"Found: {found}; not in plain MJCF: {left_out}."


@dataclass(frozen=True)
class Rollout:
    """What a run shows since the policy began, rows of 3 ms.

    Attributes:
        forward, yaw: velocity of the base in its own frame (N,) [m/s, rad/s].
        pitch_rate: (N,) [rad/s].
        force: norm of the ground's force on the rear right foot (N,) [N].
        fell_s: when it fell, if it did.
    """

    forward: np.ndarray
    yaw: np.ndarray
    pitch_rate: np.ndarray
    force: np.ndarray
    fell_s: float | None


@dataclass(frozen=True)
class Job:
    """One rollout: hardware with a set of effects, or simulation where there is a model.

    `trained` is the policy's training seed.
    """

    task: str
    policy: str
    seconds: float
    seed: int
    which: str = "clean"
    friction: float | None = None
    model: Model | None = None
    trained: int = 0

    @property
    def bundle(self) -> Path:
        """The policy's file."""
        return POLICIES / f"{self.task}_{self.policy}{f'_seed{self.trained}' if self.trained else ''}.zip"


def build_all(sets: Sequence[str], seed: int, folder: Path | None, quick: bool) -> dict[str, Simulators]:
    """Models of every set: from the folder where `chirp_response.py` left them, or identified anew."""
    if folder is not None:
        return {which: read_simulators(folder, which) for which in sets}
    return dict(zip(sets, run_trials(_build, [(which, seed, not quick) for which in sets]), strict=True))


def _build(asked: tuple[str, int, bool]) -> Simulators:
    return simulators(*asked)


def read_simulators(folder: Path, which: str) -> Simulators:
    """Models that `write_models` wrote of one set."""
    names = ("kin_only", "s3n_act", "s3n_full", "found")
    models = {name: read_model(folder / f"{which.replace(' ', '_')}_{name}.toml") for name in names}
    return _described(models)


def simulators(which: str, seed: int, search: bool = True) -> Simulators:
    """Models from recordings of the reference leg that hides this set; without `search` nothing is found."""
    plant = reference_leg(which, seed)
    known = identify_plant(plant)
    models = {name: known.variant(name) for name in ("kin_only", "s3n_act", "s3n_full")}
    if not search:
        return Simulators(models, (), ())
    return _described(models | {"found": find_effects(plant, known)[1]})


def _described(models: dict[str, Model]) -> Simulators:
    own = {effect.key for effect in models["s3n_full"].effects}
    found = tuple(str(e.key) for e in models["found"].effects if e.key not in own)
    return Simulators(models, found, make_machine("quadruped", models["found"]).left_out)


def rollout(job: Job) -> Rollout:
    """Run one job."""
    bundle = read_bundle(job.bundle)
    if job.model is None:
        made = evaluate(
            bundle, seconds=job.seconds, seed=job.seed, hidden=SETS[job.which], friction=job.friction
        )
    else:
        made = evaluate(
            bundle,
            seconds=job.seconds,
            seed=_SIMULATION_SEED,
            hardware=False,
            sensors=PERFECT,
            model=job.model,
        )
    extra, rows = made.recording.extra, round(job.seconds / STEP_S)
    linear, angular = extra["base_linear"][-rows:], extra["base_angular"][-rows:]
    force = np.linalg.norm(extra["ground_force"][-rows:, 9:12], axis=1)
    return Rollout(linear[:, 0], angular[:, 2], angular[:, 1], force, made.fell_s)
