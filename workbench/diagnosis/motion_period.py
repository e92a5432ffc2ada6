"""The period of a recorded motion: folds must not be copies of each other."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording

from .policy import POLICY


def motion_period(recording: Recording) -> int | None:
    """Return the period, in rows, of the motion of all axes; None if it is not periodic.

    The recording has two whole periods at least.
    """
    q = recording.position - recording.position.mean(axis=0)
    rows = len(q)
    power = np.sum(q**2, axis=0)
    safe = np.where(power > 0, power, 1.0)
    moves = (power > 0) & (np.sum(q[1:] * q[:-1], axis=0) > POLICY.period_smooth * safe)
    if rows < 4 or not moves.any():
        return None
    q = q[:, moves] / np.sqrt(safe[moves] / rows)
    apart = _distance(q, rows // 2)
    left = np.flatnonzero(apart > POLICY.period_left)
    if not len(left):
        return None
    near = np.flatnonzero(apart < POLICY.period_back)
    near = near[near > left[0]]
    if not len(near):
        return None
    gaps = np.flatnonzero(np.diff(near) > 1)
    valley = near[: gaps[0] + 1] if len(gaps) else near
    return int(valley[np.argmin(apart[valley])])


def _distance(q: np.ndarray, longest: int) -> np.ndarray:
    """Return the mean squared distance between the motion and its delayed copy over twice the variance, by
    delay in rows.
    """
    rows, axes = q.shape
    spectrum = np.fft.rfft(q, 2 * rows, axis=0)
    product = np.fft.irfft(np.sum(np.abs(spectrum) ** 2, axis=1), 2 * rows)[: longest + 1]
    energy = np.concatenate([[0.0], np.cumsum(np.sum(q**2, axis=1))])
    delay = np.arange(longest + 1)
    both = energy[rows - delay] + energy[-1] - energy[delay]
    return (both - 2.0 * product) / (2.0 * axes * (rows - delay))
