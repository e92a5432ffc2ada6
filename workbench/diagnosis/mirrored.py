"""An axis whose columns all have the other sign than the model's: its law holds, its physics do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import replay_of, score_runs
from workbench.core import InputError, Recording
from workbench.models import Model

_WORSE = 3.0  # times the noise, from which it is asked
_SOME = 2  # recordings are enough
_GOOD = 0.25  # of what was measured is off, as a model's that lacks an effect may be
_LEFT = 0.2  # of the error, which no effect but a sign takes off by itself
_SIGNED = (
    "position", "velocity", "torque_command", "torque_measured", "torque_feedforward", "position_reference",
    "velocity_reference", "link_position", "current", "voltage",
)  # fmt: skip


def refuse_mirrored(model: Model, recordings: Sequence[Recording], error: float, floor: float) -> None:
    """Refuse recordings of which the model explains most as soon as one axis is turned round.

    Where weight and inertia are the same either way, so is the error, and nothing is said.

    Args:
        model: what is believed.
        recordings: that were fitted.
        error, floor: of them and of the noise, as scores.

    Raises:
        InputError: names the axis.
    """
    j, some = model.transmission, recordings[:_SOME]
    if error < _WORSE * floor or np.count_nonzero(j) > len(j):
        return
    scores = {axis: _score(model, [_turned(r, k) for r in some]) for k, axis in enumerate(recordings[0].axes)}
    axis, score = min(scores.items(), key=lambda each: each[1])
    # where runs go astray, one that goes less far astray says nothing
    if score < min(_GOOD, _LEFT * (error := _score(model, some))):
        raise InputError(
            f"axis '{axis}' has the other sign than in model '{model.name}': turned round, all its columns "
            f"together, the error falls from {error:.3g} to {score:.3g}",
            file=recordings[0].source, column=axis,
            remedy="negate them, or turn the axis of the joint in the model",
        )  # fmt: skip


def _score(model: Model, recordings: Sequence[Recording]) -> float:
    """Error of the model's runs; infinite where it is unstable."""
    replay = replay_of(model, recordings)
    (runs,) = replay.run([model])
    score, _ = score_runs(replay.recordings, runs)
    return score if np.isfinite(score) else np.inf


def _turned(recording: Recording, axis: int) -> Recording:
    """The recording with an axis turned round."""
    sides = np.where(np.arange(len(recording.axes)) == axis, -1.0, 1.0)
    signals = {
        name: x * sides if name in _SIGNED and x.shape[1] == len(sides) else x
        for name, x in recording.signals.items()
    }
    return replace(recording, signals=signals)
