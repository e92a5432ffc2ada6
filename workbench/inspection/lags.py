"""Correlation of two columns, the lag between them, and whether they are rich enough to show one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import combinations

import numpy as np
import scipy

from workbench.core import Recording

from .result import Remark

ALIKE = 0.9  # correlation from which two columns are the same
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


def swapped_columns(
    recording: Recording, axes: Iterable[int], likeness: Callable[[int, int], float], what: str
) -> tuple[np.ndarray, list[Remark]]:
    """Return which column of a second signal (`what`: both, in words) each axis has (n,), and remarks on it.

    `likeness` is the correlation of an axis' column in the first signal with one in the second.
    """
    order, remarks = np.arange(len(recording.axes)), list[Remark]()
    for a, b in combinations(axes, 2):
        straight, crossed = min(likeness(a, a), likeness(b, b)), min(likeness(a, b), likeness(b, a))
        if crossed > ALIKE and 1 - crossed < 0.3 * (1 - straight):
            order[[a, b]] = order[[b, a]]
            names = [recording.axes[a], recording.axes[b]]
            text = f"{what} of '{names[0]}' and '{names[1]}' are swapped against each other."
            remarks.append(Remark("problem", "swap", None, text, {"axes": names}))
    return order, remarks


def is_broad(column: np.ndarray) -> bool:
    """Return whether a column (N,) has enough frequencies to tell delay or inertia from a tone's phase.

    Counts the frequencies among which its power is shared: the participation ratio of its spectrum.
    """
    x = column[:_MOST] - column[:_MOST].mean()
    power = np.abs(np.fft.rfft(x * np.hanning(len(x)))) ** 2
    return bool(power.sum() ** 2 > _TONES * (power**2).sum())
