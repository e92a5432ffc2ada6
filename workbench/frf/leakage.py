"""Leakage subtracted from the excited lines, and noise estimated between them.

With P periods in one transform, excited lines stand at every P-th bin. Between them there is noise, and what
the record's beginning and end leave: a transient, and motion that noise caused. That leakage is smooth along
frequency; a polynomial through the bins beside a line gives it on the line, and what scatters about the
polynomial is the noise. Two periods give many residuals a line that way, where their difference gives one;
and in a loop the scatter of periods would be too large, because each carries the leakage of its neighbours.
Pintelon and Schoukens 2012, ch. 7 (local polynomial method for periodic excitation).
"""

from __future__ import annotations

import numpy as np
import scipy.fft

_ORDER = 2
_CHUNK = 500_000  # numbers transformed at once
_BINS = (12, 48)  # beside each line: at least and at most


def spectra_between(
    columns: np.ndarray, rows: int, lines: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Return the periods' mean spectrum without leakage, the noise's covariance, degrees of freedom.

    Args:
        columns: P whole periods, P >= 2, shape (P rows, nz).
        rows: rows per period.
        lines: harmonics of the period, (L,).

    Returns:
        ``(mean, covariance, residuals)``: (L, nz) in amplitudes; (L, nz, nz) of one period, as the scatter
        of periods would have it; complex residuals behind it. None where the periods are too short.
    """
    count = len(columns) // rows
    size = len(columns)
    free = np.arange(1, (size - 1) // 2 + 1)
    free = free[free % count != 0]
    # with many periods those up to the next lines are enough
    wide = int(np.clip(2 * (count - 1), *_BINS))
    if len(free) < wide:
        return None
    bins = lines * count
    first = np.clip(np.searchsorted(free, bins) - wide // 2, 0, len(free) - wide)
    beside = free[first[:, None] + np.arange(wide)]
    away = (beside - bins[:, None]) / np.abs(beside - bins[:, None]).max(axis=1, keepdims=True)
    basis, upper = np.linalg.qr(away[:, :, None] ** np.arange(_ORDER + 1))
    spectrum = _spectrum(columns, int(max(beside.max(), bins.max())) + 1)
    there = np.moveaxis(spectrum[:, beside], 0, 2)
    inside = np.swapaxes(basis, 1, 2) @ there
    # the polynomial's value on the line is its constant term
    constant = np.linalg.inv(upper)[:, :1]
    mean = spectrum[:, bins].T - (constant @ inside)[:, 0]
    rest = there - basis @ inside
    residuals = float(wide - _ORDER - 1)
    covariance = np.swapaxes(rest, 1, 2) @ np.conj(rest) / residuals
    wider = 1.0 + np.sum(constant[:, 0] ** 2, axis=1)
    return mean, covariance * (count * wider)[:, None, None], residuals


def _spectrum(columns: np.ndarray, bins: int) -> np.ndarray:
    """Return the amplitude spectra of the columns (N, nz) up to a bin, (nz, bins)."""
    size, nz = columns.shape
    out = np.empty((nz, bins), complex)
    step = max(1, _CHUNK // size)
    for k in range(0, nz, step):  # a few columns at a time: a long record needs no second copy of all
        block = np.ascontiguousarray(columns[:, k : k + step].T)
        np.multiply(np.asarray(scipy.fft.rfft(block, axis=1))[:, :bins], 2.0 / size, out=out[k : k + step])
    return out
