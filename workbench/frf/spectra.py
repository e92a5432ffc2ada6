"""Spectra of every period at the wanted lines: mean, scatter, and the end of the transient."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
import scipy.fft

from .leakage import spectra_between

_CHUNK = 500_000  # numbers transformed at once, few enough to stay near the processor
_SURE = 1e-5  # chance of calling a period transient that is not, in each band
_LOOKED_AT = 12  # leading periods among which the transient is looked for
_BAND = 12  # lines in the lowest band; each next one has twice as many
_NOTHING = 1e-6  # part of a line's size below which a difference is rounding


@dataclass(frozen=True, eq=False)
class Spectra:
    """One experiment at L lines, nz signals (outputs, inputs, references).

    Attributes:
        mean: mean over periods, (L, nz), the amplitude spectrum scaled so that a cosine's line is its
            amplitude.
        covariance: of the noise on one period, (L, nz, nz); that of the mean is a P-th of it.
        free: complex residuals behind it.
        periods: how many, P.
        dropped: periods before these that were transient.
        settled: whether the first period left looks like the others; None where that cannot be told.
    """

    mean: np.ndarray
    covariance: np.ndarray
    free: float
    periods: int
    dropped: int
    settled: bool | None


def period_spectra(columns: np.ndarray, rows: int, lines: np.ndarray) -> np.ndarray:
    """Return the spectrum of each period at some lines.

    Args:
        columns: P whole periods, shape (P rows, nz).
        rows: rows per period.
        lines: harmonics, each below rows / 2, shape (L,).

    Returns:
        Shape (P, L, nz), complex; a cosine of amplitude one gives one.
    """
    count, nz = len(columns) // rows, columns.shape[1]
    out = np.empty((count, len(lines), nz), complex)
    step = max(1, _CHUNK // (rows * nz))
    apart = np.diff(lines)
    even = len(lines) > 1 and (apart == apart[0]).all()
    # evenly spaced lines need no copy to be picked out
    pick = slice(int(lines[0]), int(lines[-1]) + 1, int(apart[0])) if even else lines
    for k in range(0, count, step):
        block = columns[k * rows : (k + step) * rows].reshape(-1, rows, nz)
        # transforms run along rows that lie side by side in memory
        block = np.ascontiguousarray(np.swapaxes(block, 1, 2))
        spectrum = np.asarray(scipy.fft.rfft(block, axis=2))[:, :, pick]
        np.multiply(np.swapaxes(spectrum, 1, 2), 2.0 / rows, out=out[k : k + step])
    return out


def reduce(
    columns: np.ndarray,
    rows: int,
    lines: np.ndarray,
    excited: np.ndarray,
    transient: int | None,
    leakage: bool,
) -> Spectra:
    """Return mean and noise of the periods after the transient.

    With `leakage` the noise is estimated between the lines, and leakage is subtracted. Without, and where
    periods are too short for that, they are averaged, and their scatter is the noise.

    Args:
        columns: P whole periods, (P rows, nz).
        rows: rows per period.
        lines: harmonics wanted, (L,).
        excited: which of them were excited and so can tell a transient, (L,) bool.
        transient: periods to drop; None finds out.
        leakage: see above.
    """
    settled = None
    if transient is None:
        # where the first periods look like some later ones, they look like all
        first = period_spectra(columns[: _LOOKED_AT * rows], rows, lines[excited])
        transient, settled = transient_periods(first)
    columns = columns[transient * rows :]
    count = len(columns) // rows
    between = spectra_between(columns, rows, lines) if leakage else None
    if between is not None:
        mean, covariance, free = between
        return Spectra(mean, covariance, free, count, transient, settled)
    kept = period_spectra(columns, rows, lines)
    mean = kept.mean(axis=0)
    deviation = np.moveaxis(kept - mean, 0, 2)  # (L, nz, P)
    covariance = deviation @ np.conj(np.swapaxes(deviation, 1, 2)) / (count - 1)
    return Spectra(mean, covariance, count - 1.0, count, transient, settled)


def transient_periods(periods: np.ndarray) -> tuple[int, bool | None]:
    """Return how many leading periods differ from the later ones by more than these differ among themselves.

    At each line the difference of a period from the mean of the later ones, over their variance, is F
    distributed once the response is periodic. The chances of all lines of a band are put together (R. A.
    Fisher), in octaves, because a transient that decays over a part of a period sits at the lowest lines.
    At least two periods stay, and at least half of them.

    Args:
        periods: (P, L, nz), lines ascending.

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
            return drop, None
        middle = rest.mean(axis=0)
        variance = np.sum(np.abs(rest - middle) ** 2, axis=0) / (q - 1)
        floor = (_NOTHING * np.abs(middle)) ** 2 + 1e-300
        ratio = np.abs(periods[drop] - middle) ** 2 / (np.maximum(variance, floor) * (1 + 1 / q))
        chance = scipy.stats.f.logsf(ratio, 2, 2 * (q - 1))
        if all(
            scipy.stats.chi2.sf(-2 * chance[a:b].sum(axis=0).min(), 2 * (b - a)) > _SURE
            for a, b in _octaves(lines)
        ):
            return drop, True
    return count // 2, False


def _octaves(lines: int) -> list[tuple[int, int]]:
    """Return bands of lines, each about twice as wide as the one below it."""
    edges = [0]
    while lines - edges[-1] >= 3 * _BAND * len(edges):
        edges.append(edges[-1] + _BAND * 2 ** (len(edges) - 1))
    return list(pairwise([*[e for e in edges if e < lines], lines]))
