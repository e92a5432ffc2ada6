"""One trial of the contact-free leg: identify a plant, chirp it, and chirp what its recordings gave."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from transfer_identification import CONTROL_S, Identified, find_effects, found_words, identify_plant
from transfer_plants import Plant

from workbench.core import Recording, SimulationError
from workbench.models import Model
from workbench.rigs import PERFECT, VirtualLeg, chirp
from workbench.s3n import run_variant
from workbench.simulation import Run, simulate

#: Row of the tables -> name in print.
NAMES = {
    "kin_only": "Kin-Only",
    "s3n_act": "S3N-Act",
    "s3n_full": "S3N-Full",
    "exact": "exact (S3N-Full + weight)",
    "explicit": "explicit injection",
    "found": "S3N + found effects",
    "noise": "noise alone",
}


@dataclass(frozen=True)
class Trial:
    """What one trial gave.

    Attributes:
        plant: what was measured.
        known: what identification gave.
        models: by row of the tables.
        found: effects that `improve` added, as text.
        position, torque: RMSE of hip and knee, each in the chirp of its own joint (2,), by row [rad, N m].
        measured, simulated: of each chirp (2,), for the figure.
    """

    plant: Plant
    known: Identified
    models: dict[str, Model]
    found: tuple[str, ...]
    position: dict[str, np.ndarray]
    torque: dict[str, np.ndarray]
    measured: tuple[Motion, ...]
    simulated: dict[str, tuple[Motion, ...]]


@dataclass(frozen=True)
class Motion:
    """Joint coordinates: time (N,) [s], position (N, 2) [rad], torque (N, 2) [N m]."""

    time: np.ndarray
    position: np.ndarray
    torque: np.ndarray


@dataclass(frozen=True)
class Task:
    """A trial to be made, with shorter recordings if `quick`."""

    plant: Plant
    quick: bool = False


def run_trial(task: Task) -> Trial:
    """Identify, find, chirp, simulate."""
    plant = task.plant
    known = identify_plant(plant)
    length = 4.0 if task.quick else 8.0
    chirps = [chirp(joint, duration=length) for joint in ("hip", "knee")]
    logs = VirtualLeg(plant.hidden, seed=5000 + plant.seed).run(chirps)
    silent = VirtualLeg(plant.hidden, seed=5000 + plant.seed, sensors=PERFECT).run(chirps)
    models = {name: known.variant(name) for name in ("kin_only", "s3n_act", "s3n_full", "exact")}
    improvement, models["found"] = find_effects(plant, known, task.quick)
    found = found_words(improvement)
    made = simulate([Run(m, log) for m in models.values() for log in logs])
    simulated = {
        name: tuple(motion(r, known.model) for r in made[2 * k : 2 * k + 2]) for k, name in enumerate(models)
    }
    simulated["explicit"] = tuple(explicit(known.model, log) for log in logs)
    simulated["noise"] = tuple(motion(r, known.model) for r in silent)
    measured = tuple(motion(log, known.model) for log in logs)
    rows = {name: [rmse(m, s, k) for k, (m, s) in enumerate(zip(measured, runs, strict=True))]
            for name, runs in simulated.items()}  # fmt: skip
    return Trial(
        plant, known, models, found,
        {name: np.array([q for q, _ in pairs]) for name, pairs in rows.items()},
        {name: np.array([t for _, t in pairs]) for name, pairs in rows.items()},
        measured, simulated,
    )  # fmt: skip


def motion(recording: Recording, model: Model) -> Motion:
    """A recording in joint coordinates: q_s = J^-1 q_p, tau_s = J^T tau_p."""
    j = model.transmission
    return Motion(
        recording.time, recording.position @ np.linalg.inv(j).T, recording.signals["torque_measured"] @ j
    )


def explicit(model: Model, log: Recording) -> Motion:
    """The paper's own way, compensation torques from the last step's acceleration, at its step of 3 ms.

    NaN where the iteration diverges, which it does with a linkage that is heavy for its drives.
    """
    stride = round(CONTROL_S / log.period)
    reference = log.signals["position_reference"][::stride]
    kp, kd, limit = (
        np.array(x) for x in (model.controller.kp, model.controller.kd, model.actuators.torque_limit)
    )
    back, waiting = (
        np.linalg.inv(model.transmission).T,
        [np.zeros(2)] * round(model.actuators.delay_s / CONTROL_S),
    )

    def law(row: int, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        waiting.append(np.clip(back @ (kp * (reference[row] - q) - kd * v), -limit, limit))
        return waiting.pop(0)

    time = log.time[::stride]
    try:
        run = run_variant(
            model, "explicit", law, rows=len(reference), period=CONTROL_S, step=CONTROL_S,
            start=(reference[0], np.zeros(2)), strict=False,
        )  # fmt: skip
    except SimulationError:
        nothing = np.full((len(reference), 2), np.nan)
        return Motion(time, nothing, nothing)
    return Motion(time, run.position, run.torque @ model.transmission)


def rmse(measured: Motion, simulated: Motion, joint: int) -> tuple[float, float]:
    """Root mean square of simulated less measured angle and torque of one joint."""
    stride = round((simulated.time[1] - simulated.time[0]) / (measured.time[1] - measured.time[0]))
    pairs = ((simulated.position, measured.position), (simulated.torque, measured.torque))
    q, tau = (float(np.sqrt(np.mean((s - m[::stride])[:, joint] ** 2))) for s, m in pairs)
    return q, tau


def reduction(errors: dict[str, np.ndarray], name: str) -> float:
    """By how much the RMSE averaged over the joints is below Kin-Only's, as the paper has it [%]."""
    return float(100.0 * (1.0 - errors[name].mean() / errors["kin_only"].mean()))
