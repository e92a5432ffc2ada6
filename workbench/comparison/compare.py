"""Simulate a model as the recordings were made, and report its error beside the noise floor."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.core import HOPELESS, MARGIN_TOTAL, Comparison, InputError, Recording, SimulationError
from workbench.effects import load_model
from workbench.models import Model
from workbench.recordings import Source, load_recordings
from workbench.s3n import on_drives
from workbench.simulation import runs_in_loop

from .evaluate import evaluate
from .matching import explained_by_mujoco, matched
from .noise import DRAWS, NoiseModel
from .replay_of import needs_inverse, replay_of
from .score import Scale, normalised
from .soft_friction import softness_note
from .standing import on_ground


def compare(
    model: Model | str | Path, recordings: Source | Iterable[Source], *, draws: int = DRAWS, seed: int = 0
) -> Comparison:
    """Return the comparison of a model with recordings: error, noise floor, and where the error is.

    Args:
        model: what we believe, or its file or name.
        recordings: what was measured, one or several, or their files; loops of kind ``unknown`` are compared
            by inverse dynamics.
        draws: noise simulations behind the floor.
        seed: of those.

    Raises:
        InputError: a file that cannot be read, no recording, or recordings that do not fit the model.
        SimulationError: the model is unstable in the recording's loop, or noise throws it further off than
            all that was measured.
    """
    if draws < 1:
        raise InputError(f"is {draws}", column="draws", remedy="give at least 1: the floor comes from them")
    model, recordings = load_model(model), load_recordings(recordings, some=True)
    known = not any(needs_inverse(model, r) for r in recordings)
    if model.posture_dependent and not (known and runs_in_loop(model)):
        model = on_drives(model)  # which is compared along the measured motion
    taken = matched(model, recordings)
    replay = replay_of(model, taken)
    simulated = replay.with_noise(model, seed, draws)
    out = told(evaluate(model, simulated))
    made = None if out.consistent else explained_by_mujoco(model, taken, recordings)
    if made is not None:
        return compare(model, made, draws=draws, seed=seed)
    soft = None if model.posture_dependent else softness_note(model, replay, simulated)
    return replace(out, notes=(*out.notes, *filter(None, [soft])))


def told(result: Comparison) -> Comparison:
    """Return the comparison, if it can say anything.

    Raises:
        SimulationError: noise alone throws the model further off than all that was measured.
    """
    floor = result.noise_error - 3.0 * result.noise_error_std
    recordings = [entry.recording for entry in result.recordings]
    if noise_rules(floor, recordings):
        raise SimulationError(cannot_run(result.model, result.noise_error, ground=on_ground(recordings[0])))
    return result


def noise_rules(floor: float, recordings: Sequence[Recording]) -> bool:
    """Return whether the noise floor is so large that no error can be distinguished from it.

    A machine that never moved would leave an error of 1: a floor above is no nearer to the data. Where little
    but noise was measured, that is all there is to explain, and a run from a noisy state has it twice.
    """
    levels = NoiseModel.of(recordings).levels
    sensors = normalised(np.stack([levels.position_std, levels.torque_std]) ** 2, Scale.of(recordings))
    return floor > max(MARGIN_TOTAL, HOPELESS * np.nan_to_num(sensors))


def cannot_run(model: str, floor: float, *, ground: bool = False) -> str:
    """Return the message for a model whose noise floor is too large (`noise_rules`): what to check first,
    also on the `ground`.
    """
    return (
        f"model '{model}' cannot run in these loops: sensor noise alone makes its error {floor:.3g} "
        "times the measured motion; check the order of the axes, units, signs, gains and contacts "
        "between bodies"
    ) + (", where the ground is and how soft ([ground]), and log base_velocity" if ground else "")
