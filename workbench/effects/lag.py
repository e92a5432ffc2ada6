"""Exact first-order lags of torques that are constant in pieces."""

from __future__ import annotations

import numpy as np

from workbench.core.compiled import compiled


@compiled()
def follow(now: float, older: float, newer: float, fraction: float, ratio: float) -> tuple[float, float]:
    """Return one step of a lag behind a value that changes once within the step; compiled.

    Args:
        now: output at the start of the step.
        older, newer: input in the first `fraction` of the step, and after.
        fraction: share of the step.
        ratio: time constant over the step; 0 for no lag.

    Returns:
        Output at the end of the step, and its mean over it.
    """
    if ratio <= 0.0:
        return newer, fraction * older + (1.0 - fraction) * newer
    first, second = np.exp(-fraction / ratio), np.exp((fraction - 1.0) / ratio)
    middle = older + (now - older) * first
    after = newer + (middle - newer) * second
    mean = fraction * older + (1.0 - fraction) * newer
    return after, mean + ratio * ((now - older) * (1.0 - first) + (middle - newer) * (1.0 - second))


@compiled()
def lagged_line(
    older: np.ndarray, newer: np.ndarray, fraction: float, ratio: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the same over N rows, from zero: output at the start of each row, and its mean over the
    row, (N,).
    """
    out, mean, now = np.empty(len(older)), np.empty(len(older)), 0.0
    for k in range(len(older)):
        out[k] = now
        now, mean[k] = follow(now, older[k], newer[k], fraction, ratio)
    return out, mean


def heat(torque: np.ndarray, step: float, time_constant: float | np.ndarray) -> np.ndarray:
    """Return the mean over each row of the square of a torque (N,) behind a lag that starts cold."""
    square, ratio = torque**2, float(time_constant) / step
    return lagged_line(square, square, 0.0, ratio)[1]
