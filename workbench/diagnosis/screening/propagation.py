"""Sensitivities of the recorded signals to unknowns, propagated round the loops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import Recording
from workbench.simulation import Disturbance

from ..data import Data, difference
from .sensitivity import FiniteDifference, Linearisation, SensitivityColumn


def propagate_sensitivities(
    linearisations: Sequence[Linearisation],
    columns: Sequence[Sequence[SensitivityColumn | FiniteDifference]],
    data: Data,
) -> list[list[np.ndarray]]:
    """Return weighted sensitivities of the scored signals, for all linearisations in one batch.

    Args:
        linearisations: S of them.
        columns: of each linearisation.
        data: for the weights.

    Returns:
        Per linearisation and recording (N, 2, n, C): position and torque, over their deviations.
    """
    linear = [[c for c in own if isinstance(c, SensitivityColumn)] for own in columns]
    propagated = _propagated(linearisations, linear, data)
    tried = _tried(
        linearisations, [[c for c in own if isinstance(c, FiniteDifference)] for own in columns], data
    )
    out = []
    for s, own in enumerate(columns):
        first = [k for k, c in enumerate(own) if isinstance(c, SensitivityColumn)]
        second = [k for k, c in enumerate(own) if isinstance(c, FiniteDifference)]
        rows = []
        for i, run in enumerate(linearisations[s].runs):
            whole = propagated[s][i][..., : len(first)]
            if second:
                whole = np.zeros((len(run), 2, len(run.axes), len(own)))
                whole[..., first], whole[..., second] = propagated[s][i][..., : len(first)], tried[s][i]
            whole = whole * data.weight[:, :, None]
            whole[~data.recordings[i].valid] = 0.0
            rows.append(whole)
        out.append(rows)
    return out


def _propagated(
    linearisations: Sequence[Linearisation], columns: Sequence[Sequence[SensitivityColumn]], data: Data
) -> list[list[np.ndarray]]:
    """Return unweighted position and torque sensitivities, (N, 2, n, C) per linearisation and recording."""
    width = max((len(c) for c in columns), default=0)
    loops, disturbances = [], []
    for linearisation, own in zip(linearisations, columns, strict=True):
        for i, motion in enumerate(linearisation.motions if own else ()):
            torque = np.zeros((width, *motion.position.shape))
            for k, column in enumerate(own):
                torque[k] = column.torque[i]
            taps, commands, readings = (
                {k: part for k, c in enumerate(own) if (part := getattr(c, name)[i]) is not None}
                for name in ("tap", "command", "reading")
            )
            data.budget.add(data.recordings[i : i + 1], columns=width)
            loops.append(linearisation.loops[i])
            disturbances.append(Disturbance(torque, taps, commands, readings))
    flat = iter(data.replay.propagate(loops, disturbances) if loops else ())
    return [
        [np.stack(next(flat), axis=1) for _ in linearisation.motions]
        if own
        else [_empty(r) for r in linearisation.runs]
        for linearisation, own in zip(linearisations, columns, strict=True)
    ]


def _empty(run: Recording) -> np.ndarray:
    return np.zeros((len(run), 2, len(run.axes), 0))


def _tried(
    linearisations: Sequence[Linearisation], trials: Sequence[Sequence[FiniteDifference]], data: Data
) -> list[list[np.ndarray]]:
    """The same from finite differences of simulations, in one batch; zero for models that fail to run."""
    asked = [t.model for own in trials for t in own]
    runs = data.run(asked, len(linearisations[0].runs)) if asked else []
    made = iter([r for own in runs for r in own])
    out = []
    for linearisation, own in zip(linearisations, trials, strict=True):
        slopes = [
            [
                _finite(difference(next(made), run, data.recordings[i])) / t.change
                for i, run in enumerate(linearisation.runs)
            ]
            for t in own
        ]
        rows = range(len(linearisation.runs))
        out.append(
            [
                np.stack([s[i] for s in slopes], axis=-1) if own else _empty(linearisation.runs[i])
                for i in rows
            ]
        )
    return out


def _finite(change: np.ndarray) -> np.ndarray:
    return change if np.isfinite(change).all() else np.zeros_like(change)
