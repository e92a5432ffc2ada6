"""Intervals of what is a function of means: blocks or strides are drawn anew, with replacement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

_DRAWS = 400
_FEWEST = 3  # blocks; fewer have no interval


@dataclass(frozen=True)
class Interval:
    """A number and its 95 % interval; infinitely wide where too few blocks or strides were seen."""

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"


def resampled(statistic: Callable[..., np.ndarray], *blocks: np.ndarray, seed: int = 0) -> Interval:
    """Return a statistic of the means of blocks, with a bootstrap interval (Efron, percentiles).

    Args:
        statistic: of one array of means (..., k) for each of `blocks`; gives (...,).
        blocks: (B, k) each, numbers of B blocks that know little of each other: seconds, strides, swings.
        seed: of the drawing.
    """
    value = float(statistic(*(b.mean(axis=0) for b in blocks)))
    if min(map(len, blocks)) < _FEWEST:
        return Interval(value, -np.inf, np.inf)
    generator = np.random.default_rng([seed, 21])
    means = []
    for b in blocks:
        counts = generator.multinomial(len(b), np.full(len(b), 1.0 / len(b)), _DRAWS)
        means.append(counts @ b / len(b))
    low, high = np.nanpercentile(statistic(*means), [2.5, 97.5])
    return Interval(value, float(low), float(high))
