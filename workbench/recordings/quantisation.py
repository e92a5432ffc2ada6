"""The resolution of an encoder: the step of which all positions are multiples, if there is one."""

from __future__ import annotations

import numpy as np


def quantisation_step(values: np.ndarray) -> float:
    """Return the largest step of which all differences of the values are multiples.

    Args:
        values: shape (N,). Rounding when written (a few parts in a thousand of a step)
            does no harm.

    Returns:
        The step in the values' unit; 0.0 if the values are multiples of no step, or are all equal.
    """
    places = np.unique(values)
    merge = 1e-9 * float(np.abs(places).max())
    gaps = np.diff(places)
    gaps = gaps[gaps > merge]
    if len(gaps) == 0:
        return 0.0
    # neighbours are one step apart nearly everywhere; where they are not, the gap counts the steps
    step = float(np.median(gaps[gaps < 1.5 * gaps.min()]))
    # written with few digits, a narrow gap tells the step roughly, and wider ones tell it better
    reach = 2.0
    while reach * step < 2.0 * gaps.max():
        near = gaps[gaps < reach * step]
        step = float(near.sum() / np.round(near / step).sum())
        reach *= 2.0
    return step if _fits(gaps, np.round(gaps / step), step) else 0.0


def _fits(gaps: np.ndarray, counts: np.ndarray, step: float) -> bool:
    return bool(np.abs(gaps - counts * step).max() < 0.05 * step)
