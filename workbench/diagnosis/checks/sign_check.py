"""The sign check: finds axes whose columns have the opposite sign of the model's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.comparison import (
    Turn,
    replay_of,
    reversed_torques,
    score_runs,
    shifted_axes,
    swapped_axes,
    turned_axes,
)
from workbench.core import InputError, Recording, SimulationError
from workbench.models import Model

from ..policy import POLICY

_EXCHANGE = "exchange them in [columns], or the names of the joints in the model"
_ZERO = "add that as offset in [columns], in the unit of [units], or move the zero of the joints in the model"
_NEGATE = "negate its columns (scale = -1.0 in [columns], or a negative factor in [units])"
_REMEDY = "negate them (scale = -1.0 in [columns]), or turn the axis of the joint in the model"


def refuse_wrong_sign_of_torque(model: Model, recordings: Sequence[Recording]) -> None:
    """Refuse recordings whose torque the model explains once axes are negated, swapped or shifted.

    That takes seconds where the loops take minutes, and needs no command.

    Raises:
        InputError: names the axes and columns.
    """
    found = turned_axes(model, recordings)
    if found is None:
        if swapped := swapped_axes(model, recordings):
            first, second = swapped.axes
            raise InputError(
                f"the columns of '{first}' and '{second}' are swapped for model '{model.name}': {swapped}",
                file=recordings[0].source, column=f"{first}, {second}", remedy=_EXCHANGE,
            )  # fmt: skip
        if shifted := shifted_axes(model, recordings):
            raise InputError(
                f"positions are measured from a different zero than in model '{model.name}': {shifted}",
                file=recordings[0].source, column=", ".join(shifted.by), remedy=_ZERO,
            )  # fmt: skip
        if wrong := reversed_torques(model, recordings):
            raise InputError(
                f"model '{model.name}': {wrong}",
                file=recordings[0].source, column=", ".join(wrong.axes), remedy=_NEGATE,
            )  # fmt: skip
        return
    axes = list(dict.fromkeys(turn.axis for turn in found.turns))
    raise InputError(
        f"{_named(axes)} has the opposite sign to that in model '{model.name}': {found}",
        file=recordings[0].source, column=" or ".join(axes), remedy=_REMEDY,
    )  # fmt: skip


def refuse_wrong_sign_in_loop(
    model: Model, recordings: Sequence[Recording], error: float, floor: float
) -> None:
    """Refuse recordings that the model mostly explains in the loop once the sign of one axis is changed.

    Where weight and inertia are the same either way, so is the error, and nothing is said.

    Args:
        model: what is believed.
        recordings: that were fitted.
        error, floor: of them and of the noise, as scores.

    Raises:
        InputError: names the axis, or all that explain the recordings alike.
    """
    j, some = model.transmission, recordings[: POLICY.check_recordings]
    if error < POLICY.sign_above * floor or np.count_nonzero(j) > len(j):
        return
    turns = [Turn(axis, motion=True, torque=True) for axis in recordings[0].axes]
    scores = {turn.axis: _score(model, [turn.of(r) for r in some]) for turn in turns}
    score = min(scores.values())
    # where all runs are far off, one that is less far off says nothing
    if score < min(POLICY.sign_error, POLICY.sign_left * (error := _score(model, some))):
        axes = [axis for axis, own in scores.items() if own <= POLICY.sign_alike * score]
        both = ", whichever of them is negated" if len(axes) > 1 else ""
        raise InputError(
            f"{_named(axes)} has the opposite sign to that in model '{model.name}': with all its "
            f"columns negated, the error falls from {error:.3g} to {score:.3g}{both}",
            file=recordings[0].source, column=" or ".join(axes), remedy=_REMEDY,
        )  # fmt: skip


def _named(axes: Sequence[str]) -> str:
    return "axis " + " or ".join(f"'{axis}'" for axis in axes)


def _score(model: Model, recordings: Sequence[Recording]) -> float:
    """Return the error of the model's runs; infinite if it is unstable or links are where they cannot be."""
    try:
        replay = replay_of(model, recordings)
    except SimulationError:
        return np.inf
    (runs,) = replay.run([model])
    score, _ = score_runs(replay.recordings, runs)
    return score if np.isfinite(score) else np.inf
