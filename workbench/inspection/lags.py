"""Correlation of two columns, the lag between them, and whether they are rich enough to show one."""

from __future__ import annotations

import numpy as np
import scipy

_MOST = 200_000  # rows; more would not move a lag
_TONES = 4.0  # frequencies that a column is made of, below which its phase is no delay; one tone counts two


def alike(a: np.ndarray, b: np.ndarray) -> float:
    """Return the absolute correlation of two columns (N,); 0 if one is constant."""
    if np.ptp(a) == 0 or np.ptp(b) == 0:
        return 0.0
    return float(abs(np.corrcoef(a, b)[0, 1]))


def follow(leader: np.ndarray, follower: np.ndarray, reach: int) -> tuple[int, float]:
    """Return the number of rows by which `follower` lags `leader`, and the absolute correlation there.

    Args:
        leader, follower: shape (N,).
        reach: the largest lag looked for, to either side.
    """
    a, b = leader[:_MOST] - leader[:_MOST].mean(), follower[:_MOST] - follower[:_MOST].mean()
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    if size == 0:
        return 0, 0.0
    reach = min(reach, len(a) - 1)
    middle = len(a) - 1
    at = np.abs(scipy.signal.correlate(b, a, mode="full", method="fft")[middle - reach : middle + reach + 1])
    lag = int(np.argmax(at))
    return lag - reach, float(min(1.0, at[lag] / size))


def is_broad(column: np.ndarray) -> bool:
    """Return whether a column (N,) has enough frequencies to tell delay or inertia from a tone's phase.

    Counts the frequencies among which its power is shared: the participation ratio of its spectrum.
    """
    x = column[:_MOST] - column[:_MOST].mean()
    power = np.abs(np.fft.rfft(x * np.hanning(len(x)))) ** 2
    return bool(power.sum() ** 2 > _TONES * (power**2).sum())
