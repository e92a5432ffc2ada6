"""The shipped policies of the transfer study, and the simulators that all of them are crossed with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from transfer_identification import find_effects, identify_plant
from transfer_plants import reference_leg

from workbench.models import read_model, write_model
from workbench.training.machine import make_machine

POLICIES = Path(__file__).parents[1] / "policies"
#: What policies were trained in -> name in print.
TRAINED_IN = {
    "kin_only": "Kin-Only",
    "kin_only_hr": "Kin-Only HR",
    "s3n_act": "S3N-Act",
    "s3n_act_hr": "S3N-Act HR",
    "s3n_full": "S3N-Full",
    "s3n_full_hr": "S3N-Full HR",
}
#: The paper's own implementation: trained with injected torques; no simulator of the crossed tables.
INJECTED = "explicit"
#: Tasks that are files.
TASK_FILES = {
    task: Path(__file__).with_name(file)
    for task, file in (("trot", "fast_trot.py"), ("jump", "trained_jump.py"), ("payload", "payload_lap.py"))
}
#: What judges them -> name in print, from the least to the most that is known.
SIMULATORS = {
    "kin_only": "Kin-Only",
    "s3n_act": "S3N-Act",
    "s3n_full": "S3N-Full",
    "found": "S3N + found effects",
}


@dataclass(frozen=True)
class Trained:
    """A shipped policy: its task, what it was trained in, its training seed, its file."""

    task: str
    method: str
    seed: int
    file: Path


def policies_of(
    task: str, trained: int, quick: bool = False, methods: Iterable[str] = TRAINED_IN
) -> list[Trained]:
    """The shipped policies of a task, of so many training seeds; `quick`: a seed of some."""
    found = [
        Trained(task, method, seed, POLICIES / f"{task}_{method}{f'_seed{seed}' if seed else ''}.zip")
        for method in methods for seed in range(trained)
    ]  # fmt: skip
    there = [p for p in found if p.file.exists()]
    few = "kin_only", "s3n_full", INJECTED
    return [p for p in there if p.seed == 0 and p.method in few] if quick else there


def simulators(which: str, seed: int, folder: Path, quick: bool = False) -> dict[str, Path]:
    """Model files of `SIMULATORS`, identified on the leg that hides this set, or those that are there.

    `chirp_response.py` leaves the same files. `quick` finds nothing.
    """
    names = [name for name in SIMULATORS if not (quick and name == "found")]
    files = {name: folder / f"{which.replace(' ', '_')}_{name}.toml" for name in names}
    if all(file.exists() for file in files.values()):
        return files
    plant = reference_leg(which, seed)
    known = identify_plant(plant)
    for name, file in files.items():
        model = find_effects(plant, known)[1] if name == "found" else known.variant(name)
        write_model(model, file, force=True)
    return files


def about(files: dict[str, Path]) -> str:
    """What was found, and what of it plain MJCF cannot hold."""
    if "found" not in files:
        return "Nothing was looked for."
    model, base = read_model(files["found"]), read_model(files["s3n_full"])
    own = {effect.key for effect in base.effects}
    found = ", ".join(str(e.key) for e in model.effects if e.key not in own) or "nothing"
    left_out = ", ".join(make_machine("quadruped", model).left_out) or "nothing"
    return f"Found: {found}; not in plain MJCF: {left_out}."
