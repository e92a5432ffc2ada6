"""Velocity from position, without delay, filtered only as much as the encoder's resolution requires."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy

_ORDER = 3


def derive_velocity(position: np.ndarray, period: float) -> np.ndarray:
    """Return the velocity of each axis by a zero-phase Savitzky-Golay filter.

    A cubic is fitted to a window around each row. The window is as wide as the motion's bandwidth
    allows: the highest frequency at which the position's spectrum stands above its noise floor.
    Cut-off of the filter after R. W. Schafer, "What is a Savitzky-Golay filter?", 2011, eq. (4).

    Args:
        position: shape (N, n) [rad or m].
        period: row period [s].

    Returns:
        Velocity, shape (N, n) [rad/s or m/s].
    """
    if len(position) < 8:
        return np.gradient(position, period, axis=0)
    return np.column_stack([_derive(column, period) for column in position.T])


def _derive(position: np.ndarray, period: float) -> np.ndarray:
    cutoff = min(1.0, 2 * _bandwidth(position, period) * 2 * period)  # in units of half the row rate
    half = round((_ORDER + 1 + 4.6 * cutoff) / (3.2 * cutoff))
    half = int(np.clip(half, 2, (len(position) - 1) // 2))
    return np.asarray(
        scipy.signal.savgol_filter(position, 2 * half + 1, _ORDER, deriv=1, delta=period, mode="interp")
    )


def _bandwidth(position: np.ndarray, period: float) -> float:
    """Return the highest frequency with motion above the noise floor [Hz]."""
    # the difference whitens a motion that falls steeply with frequency, so that the window does not leak
    segment = min(len(position) - 1, max(64, round(1.0 / period)))
    f, power = scipy.signal.welch(np.diff(position), 1 / period, nperseg=segment)
    if not power[1:].any():
        return 0.25 / period
    power, f = power[1:] / np.sin(np.pi * f[1:] * period) ** 2, f[1:]
    floor = np.median(power[-len(power) // 4 :])
    # medians over bands: an encoder's rounding of a steady motion makes lines far above its own floor
    edges = np.unique(np.geomspace(1, len(f), 2 + round(6 * np.log2(len(f)))).astype(int)) - 1
    bands = [(a, b) for a, b in pairwise(edges) if np.median(power[a:b]) > 4 * floor]
    return float(f[bands[-1][1]]) if bands else float(f[0])
