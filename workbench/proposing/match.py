"""Comparison of columns: which is the derivative of which, which follows which, with which scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from workbench.recordings.velocity import derive_velocity

#: Likeness from which two columns are of one thing.
ALIKE = 0.9
_MOST = 60_000  # rows looked at
_REACH = 40  # rows of delay looked for
_FINEST = 0.02  # share of the changes, of which the largest is about the resolution
_SINGLE = 2.5  # resolutions by which a coarse number typically changes


@dataclass(frozen=True)
class Relation:
    """``b(k) = factor * a(k - lag)``, as far as `likeness` (0 to 1) says."""

    factor: float
    lag: int
    likeness: float


def slope(position: np.ndarray) -> np.ndarray:
    """Return the smoothed change of a column per row, shape (N,)."""
    return derive_velocity(position[:, None], 1.0)[:, 0]


def derivative(position: np.ndarray, velocity: np.ndarray) -> Relation:
    """Return how well a column is the derivative (per row) of another; both shape (N,), finite."""
    position, velocity = position[:_MOST], velocity[:_MOST]
    if _stands(position) or _stands(velocity):
        return Relation(0.0, 0, 0.0)
    change = slope(position)
    return _relation(*_smooth(change, velocity))


def follows(a: np.ndarray, b: np.ndarray) -> Relation:
    """Return how well column b is column a with a delay and a scale; offsets are ignored."""
    a, b = a[:_MOST], b[:_MOST]
    if _stands(a) or _stands(b):
        return Relation(0.0, 0, 0.0)
    return _relation(a - a.mean(), b - b.mean())


def _stands(values: np.ndarray) -> bool:
    """Whether a column moves by no more than the rounding of floats."""
    return bool(np.ptp(values) <= 1e-9 * (1 + np.abs(values).max()))


def _relation(a: np.ndarray, b: np.ndarray) -> Relation:
    reach = min(_REACH, len(a) // 4)
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    if size == 0 or reach < 1:
        return Relation(0.0, 0, 0.0)
    middle = len(a) - 1
    by_lag = (
        scipy.signal.correlate(b, a, mode="full", method="fft")[middle - reach : middle + reach + 1] / size
    )
    at = int(np.argmax(np.abs(by_lag)))
    lag = at - reach
    x, y = (a[: len(a) - lag], b[lag:]) if lag >= 0 else (a[-lag:], b[:lag])
    total = float(x @ x)
    return Relation(float(x @ y) / total if total else 0.0, lag, min(1.0, abs(float(by_lag[at]))))


def _smooth(change: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both through one moving mean as wide as the motion allows, so that noise does not shrink the factor."""
    power = np.abs(np.fft.rfft(change - change.mean())) ** 2
    top = np.searchsorted(np.cumsum(power) / max(power.sum(), 1e-300), 0.95) / len(change)  # per row
    width = int(np.clip(0.1 / max(top, 1e-4), 1, 101))
    return scipy.ndimage.uniform_filter1d(change, width), scipy.ndimage.uniform_filter1d(velocity, width)


def held_share(values: np.ndarray) -> float:
    """Return the share of rows at which a column keeps its value, zeros (drives off) left out.

    Zero where a coarse sensor explains it: its numbers change by single steps, and one row after the other.
    """
    on = (values[1:] != 0) | (values[:-1] != 0)
    changes = np.abs(np.diff(values)[on])
    changes = changes[changes > 0]
    if not len(changes):
        return float(on.any())
    single = np.median(changes) < _SINGLE * np.quantile(changes, _FINEST)
    rows = np.diff(np.flatnonzero(np.diff(values)))  # for which a value stays
    if single and len(rows) and np.bincount(rows).argmax() == 1:
        return 0.0
    return 1.0 - len(changes) / float(on.sum())
