"""Spectra of every period at the lines wanted: their mean, their scatter, and when the transient is over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft
from scipy import stats

_CHUNK = 4_000_000  # numbers transformed at once: a few periods of a long record, all of a short one
_SURE = 5.0  # deviations by which a period must stand out to be called transient
_NOTHING = 1e-6  # part of a line's size below which a difference is rounding


@dataclass(frozen=True, eq=False)
class Spectra:
    """One experiment at L lines, nz signals (outputs, inputs, references).

    Attributes:
        mean: mean over periods, (L, nz), the amplitude spectrum scaled so that a cosine's line is its
            amplitude.
        scatter: sum over periods of deviation deviation^H, (L, nz, nz).
        periods: how many, P.
        dropped: periods before these that were transient.
        settled: whether the first period left looks like the others; None where that cannot be told.
    """

    mean: np.ndarray
    scatter: np.ndarray
    periods: int
    dropped: int
    settled: bool | None


def period_spectra(columns: np.ndarray, rows: int, lines: np.ndarray) -> np.ndarray:
    """Spectrum of each period at some lines.

    Args:
        columns: P whole periods, shape (P rows, nz).
        rows: rows a period.
        lines: harmonics, each below rows / 2, shape (L,).

    Returns:
        Shape (P, L, nz), complex; a cosine of amplitude one gives one.
    """
    count, nz = len(columns) // rows, columns.shape[1]
    out = np.empty((count, len(lines), nz), complex)
    step = max(1, _CHUNK // (rows * nz))
    for k in range(0, count, step):
        block = columns[k * rows : (k + step) * rows].reshape(-1, rows, nz)
        # transforms run along rows that lie side by side in memory
        block = np.ascontiguousarray(np.swapaxes(block, 1, 2))
        spectrum = np.asarray(scipy.fft.rfft(block, axis=2))[:, :, lines]
        out[k : k + step] = np.swapaxes(spectrum, 1, 2)
    out *= 2.0 / rows
    return out


def reduce(periods: np.ndarray, lines_checked: np.ndarray, transient: int | None) -> Spectra:
    """Mean and scatter of the periods behind the transient.

    Args:
        periods: (P, L, nz).
        lines_checked: which lines tell a transient, (L,) bool.
        transient: periods to drop; None finds out.
    """
    settled = None
    if transient is None:
        transient, settled = transient_periods(periods[:, lines_checked])
    kept = periods[transient:]
    mean = kept.mean(axis=0)
    deviation = np.moveaxis(kept - mean, 0, 2)  # (L, nz, P)
    scatter = deviation @ np.conj(np.swapaxes(deviation, 1, 2))
    return Spectra(mean, scatter, len(kept), transient, settled)


def transient_periods(periods: np.ndarray) -> tuple[int, bool | None]:
    """How many leading periods differ from those behind them by more than these differ among themselves.

    At each line the difference of a period from the mean of the later ones, over their variance, is F
    distributed once the response is periodic. A period is transient where far more lines than chance
    allows exceed the 95 % quantile. At least two periods stay, and at least half of them.

    Args:
        periods: (P, L, nz).

    Returns:
        ``(dropped, settled)``; `settled` is None with fewer than three periods or ten lines.
    """
    count, lines, _ = periods.shape
    if count < 3 or lines < 10:
        return 0, None
    for drop in range(count // 2 + 1):
        rest = periods[drop + 1 :]
        q = len(rest)
        if q < 2:
            return max(drop - 1, 0), False
        middle = rest.mean(axis=0)
        variance = np.sum(np.abs(rest - middle) ** 2, axis=0) / (q - 1)
        floor = (_NOTHING * np.abs(middle)) ** 2 + 1e-300
        ratio = np.abs(periods[drop] - middle) ** 2 / (np.maximum(variance, floor) * (1 + 1 / q))
        over = np.mean(ratio > stats.f.ppf(0.95, 2, 2 * (q - 1)), axis=0)
        if over.max() < 0.05 + _SURE * np.sqrt(0.05 * 0.95 / lines):
            return drop, True
    return count // 2, False
