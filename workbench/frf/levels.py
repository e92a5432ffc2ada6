"""Lines of a measured spectrum that were excited on purpose: by their size, not only because they repeat.

A nonlinear machine answers a periodic excitation periodically: its distortion, and what feedback and the
drive make of it, repeats on lines that were never excited, so that periods agree there far better than noise
would let them. But it is smaller. Pintelon and Schoukens 2012, ch. 2 (noise from the periods) and ch. 4.
"""

from __future__ import annotations

import numpy as np
import scipy

_CHANCE = 1e-4  # of calling noise periodic, over all lines of a recording
_STEP = 5.0  # neighbours of an excitation an octave apart that falls as 1/f^2 differ by four
_FEWEST = 4  # lines above a step: a sharp resonance of the loop lifts fewer
_LEAST, _LOCALLY = 0.01, 0.03  # part of the largest line, and of the shape about one: less is distortion


def excited_levels(spectra: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Return the lines that exceed noise and distortion, (L,) bool.

    Sizes go from the largest downwards without a step as long as lines were excited; behind the first step
    lies what the machine made of them. They are looked at as they are, since most excitations are flat, and
    then against the shape that they have over frequency, since the small lines of one that is not may be
    smaller than the distortion beside its large ones.

    Args:
        spectra: of P periods on n axes, (P, L, n).
        lines: the harmonics that they are taken at, ascending, (L,).
    """
    count = len(spectra)
    mean = spectra.mean(axis=0)
    variance = np.sum(np.abs(spectra - mean) ** 2, axis=0) / (count - 1)
    ratio = count * np.abs(mean) ** 2 / np.maximum(variance, 1e-300)
    repeats = ratio > scipy.stats.f.ppf(1 - _CHANCE / mean.size, 2, 2 * (count - 1))
    size = np.where(repeats, np.abs(mean), 0.0).max(axis=1)
    size = np.where(_above_step(size), size, 0.0)
    out = size > _LEAST * size.max(initial=0.0)
    relative = size / np.maximum(_shape(size, lines), 1e-300)
    return out & _above_step(relative) & (relative > _LOCALLY)


def _above_step(size: np.ndarray) -> np.ndarray:
    """Return the lines above the first large step of the sorted sizes, (L,) bool; else all but zeros."""
    order = np.sort(size[size > 0])[::-1]
    steps = np.flatnonzero(order[:-1] > _STEP * order[1:])
    steps = steps[steps >= _FEWEST - 1]
    return size >= order[steps[0]] if len(steps) else size > 0


def _shape(size: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Return the lowest curve above all sizes (L,) that rises and falls by at most 40 dB per decade.

    So steep is torque that moves an inertia by as much at every frequency, or the motion by a flat torque.
    """
    square = lines**2.0
    behind = np.maximum.accumulate(size * square) / square
    ahead = np.maximum.accumulate((size / square)[::-1])[::-1] * square
    return np.maximum(behind, ahead)
