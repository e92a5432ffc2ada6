"""First-order lags of torques that are constant in pieces, exact."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter


def follow(
    now: np.ndarray, older: np.ndarray, newer: np.ndarray, fraction: np.ndarray, ratio: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """One step of a lag behind a value that changes once within the step; arrays broadcast.

    Args:
        now: output at the start of the step.
        older, newer: input in the first `fraction` of the step, and after.
        fraction: share of the step.
        ratio: time constant over the step; 0 for no lag.

    Returns:
        Output at the end of the step, and its mean over it.
    """
    safe = np.where(ratio > 0, ratio, 1.0)
    first = np.where(ratio > 0, np.exp(-fraction / safe), 0.0)
    second = np.where(ratio > 0, np.exp((fraction - 1.0) / safe), 0.0)
    middle = older + (now - older) * first
    after = newer + (middle - newer) * second
    mean = fraction * older + (1.0 - fraction) * newer
    mean = mean + ratio * ((now - older) * (1.0 - first) + (middle - newer) * (1.0 - second))
    return after, mean


def lagged_line(
    older: np.ndarray, newer: np.ndarray, fraction: float, ratio: float
) -> tuple[np.ndarray, np.ndarray]:
    """The same over N rows, from zero: output at the start of each row, and its mean over the row, (N,)."""
    first, second = np.exp(-fraction / ratio), np.exp((fraction - 1.0) / ratio)
    added = (1.0 - first) * second * older + (1.0 - second) * newer
    after = lfilter([1.0], [1.0, -first * second], added)
    now = np.concatenate([[0.0], after[:-1]])
    share, over = np.asarray(fraction), np.asarray(ratio)
    return now, follow(now, older, newer, share, over)[1]


def heat(torque: np.ndarray, step: float, time_constant: float | np.ndarray) -> np.ndarray:
    """Mean over each row of the square of a torque (N,) behind a lag that starts cold."""
    square, ratio = torque**2, float(time_constant) / step
    return lagged_line(square, square, 0.0, ratio)[1]
