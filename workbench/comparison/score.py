"""The score: normalised root mean square errors, pooled over recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import Recording
from workbench.simulation import scored_torque


def scored_signals(recording: Recording) -> tuple[str, ...]:
    """Return the names of the compared signals: position, and a torque if there is one."""
    torque = scored_torque(recording)
    return ("position",) if torque is None else ("position", torque)


def follows_motion(recording: Recording) -> bool:
    """Return whether models follow the measured position because no loop is known, so that position is not
    scored.
    """
    return recording.controller.kind == "unknown"


@dataclass(frozen=True)
class Scale:
    """Standard deviations of the measured signals, pooled over recordings; NaN for a signal that never
    moves.

    `position`, `torque`: (n,).
    """

    position: np.ndarray
    torque: np.ndarray

    @staticmethod
    def of(recordings: Sequence[Recording]) -> Scale:
        """Return the deviations of the signals of these recordings."""
        return Scale(*(pooled_std(recordings, kind) for kind in ("position", "torque")))

    def stack(self) -> np.ndarray:
        """Return both kinds as one array, (2, n)."""
        return np.stack([self.position, self.torque])


def pooled_std(recordings: Sequence[Recording], kind: str) -> np.ndarray:
    """Return the pooled standard deviation (n,) of ``position`` or ``torque``; NaN for a signal that never
    moves.
    """
    n = recordings[0].position.shape[1]
    parts = []
    for r in recordings:
        if kind == "position" and follows_motion(r):
            continue
        name = "position" if kind == "position" else scored_torque(r)
        if name is not None:
            parts.append(r.signals[name][r.valid])
    if not parts:
        return np.full(n, np.nan)
    values = np.concatenate(parts)
    std = values.std(axis=0)
    return np.where(np.ptp(values, axis=0) > 0, std, np.nan)


def squares(measured: Recording, simulated: Recording, names: Sequence[str] | None = None) -> np.ndarray:
    """Return sums of squared differences over valid rows, (2, n): position, torque; NaN where not compared.

    `names` are the signals to take; by default those that `measured` is scored on.
    """
    out = np.full((2, measured.position.shape[1]), np.nan)
    for k, name in enumerate(scored_signals(measured) if names is None else names):
        difference = measured.signals[name] - simulated.signals[name]
        out[k] = np.sum(difference[measured.valid] ** 2, axis=0)
    if follows_motion(measured):
        out[0] = np.nan
    return out


def normalised(mean_squares: np.ndarray, scale: Scale) -> float:
    """Return the root mean square over axes and kinds of RMSE divided by standard deviation; (2, n) ->
    number.
    """
    ratio = mean_squares / scale.stack() ** 2
    return float(np.sqrt(np.nanmean(ratio))) if np.isfinite(ratio).any() else float("nan")


def pooled(sums: Sequence[np.ndarray], counts: Sequence[int]) -> np.ndarray:
    """Return mean squares (2, n), pooled by samples, from sums per recording and their counts."""
    stacked = np.stack(sums)
    weights = np.where(np.isfinite(stacked), np.array(counts)[:, None, None], 0)
    total = np.nansum(stacked, axis=0)
    count = weights.sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def score_runs(recordings: Sequence[Recording], runs: Sequence[Recording]) -> tuple[float, list[np.ndarray]]:
    """Return `Comparison.error` of runs without noise, and the root mean squares behind it.

    Args:
        recordings: measured.
        runs: simulated, one per recording.

    Returns:
        The error, and per recording position and torque RMSE, (2, n); NaN where not compared.
    """
    counts = [int(np.sum(r.valid)) for r in recordings]
    sums = [squares(r, s) for r, s in zip(recordings, runs, strict=True)]
    error = normalised(pooled(sums, counts), Scale.of(recordings))
    return error, [np.sqrt(s / c) for s, c in zip(sums, counts, strict=True)]
