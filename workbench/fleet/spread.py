"""One parameter across robots: do they differ by more than their intervals say, and does one stand out?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, ndtr, stdtr

_SURE = 0.05  # chance that any of a fleet of equals is said to stand out


@dataclass(frozen=True)
class Spread:
    """Estimates of one parameter, one per robot.

    Attributes:
        mean: over robots, weighted by what is known of each and by how much they differ.
        std: of the mean.
        between: standard deviation of the robots' own values, estimation errors subtracted; 0 where these
            explain all.
        ratio: scatter over what the estimates' deviations let expect; about 1 for robots that are alike.
        p_value: chance of at least this scatter if all were alike.
        deviations: of each from the others, in standard deviations, shape (k,); NaN for fewer than three.
        stands_out: which do so, beyond what the worst of so many equals would, shape (k,) bool.
    """

    mean: float
    std: float
    between: float
    ratio: float
    p_value: float
    deviations: np.ndarray
    stands_out: np.ndarray


def spread(values: Sequence[float] | np.ndarray, stds: Sequence[float] | np.ndarray) -> Spread:
    """Random-effects summary of estimates with known deviations.

    Scatter is judged by Cochran's Q, robots' own variance is the moment estimate of DerSimonian and Laird
    ("Meta-analysis in clinical trials", Controlled Clinical Trials 7, 1986). Each robot is held against the
    summary of the others, which it cannot pull to its side.

    Args:
        values: estimates, k >= 2.
        stds: their standard deviations, positive.
    """
    x, s = np.asarray(values, float), np.asarray(stds, float)
    k = len(x)
    q = _scatter(x, s)
    between = _between(x, s)
    weight = 1.0 / (s**2 + between)
    deviations, chance = np.full(k, np.nan), np.ones(k)
    for i in range(k if k > 2 else 0):
        rest = np.arange(k) != i
        own = _between(x[rest], s[rest])
        w = 1.0 / (s[rest] ** 2 + own)
        mean = np.sum(w * x[rest]) / np.sum(w)
        deviations[i] = (x[i] - mean) / np.sqrt(s[i] ** 2 + own + 1.0 / np.sum(w))
        # how much the others differ is known from few of them
        off = -abs(deviations[i])
        chance[i] = 2.0 * (stdtr(k - 2, off) if own > 0 else ndtr(off))
    return Spread(
        mean=float(np.sum(weight * x) / np.sum(weight)),
        std=float(1.0 / np.sqrt(np.sum(weight))),
        between=float(np.sqrt(between)),
        ratio=float(np.sqrt(q / (k - 1))),
        p_value=float(chdtrc(k - 1, q)),
        deviations=deviations,
        stands_out=chance < _SURE / k,
    )


def _scatter(x: np.ndarray, s: np.ndarray) -> float:
    """Cochran's Q."""
    w = 1.0 / s**2
    return float(np.sum(w * (x - np.sum(w * x) / np.sum(w)) ** 2))


def _between(x: np.ndarray, s: np.ndarray) -> float:
    """Variance of robots' own values."""
    w = 1.0 / s**2
    size = np.sum(w) - np.sum(w**2) / np.sum(w)
    return max(0.0, (_scatter(x, s) - (len(x) - 1)) / size) if len(x) > 1 else 0.0
