"""Paired statistics: every unit (a policy of one training seed, a jump) in every simulator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import t

_NOTHING = "–"


@dataclass(frozen=True)
class Spread:
    """A mean and half of its 95 % interval, by Student's t over the units; NaN of fewer than two."""

    mean: float
    half: float

    @staticmethod
    def of(values: np.ndarray) -> Spread:
        """Of values (U,); those that are not finite are left out."""
        x = values[np.isfinite(values)]
        if not len(x):
            return Spread(np.nan, np.nan)
        if len(x) < 2:
            return Spread(float(x[0]), np.nan)
        half = t.ppf(0.975, len(x) - 1) * x.std(ddof=1) / np.sqrt(len(x))
        return Spread(float(x.mean()), float(half))

    def text(self, digits: int = 2) -> str:
        """``2.31 ± 0.12``."""
        if not np.isfinite(self.mean):
            return _NOTHING
        mean = f"{self.mean:.{digits}f}"
        return mean if not np.isfinite(self.half) else f"{mean} ± {self.half:.{digits}f}"


def ladder(values: Mapping[str, np.ndarray]) -> str:
    """How each simulator compares with the next, by their paired differences: ``>``, ``<`` or ``=``.

    ``>``: the interval of the difference is above zero, the next one's gap is smaller. ``=``: it holds zero.
    """
    names = list(values)
    steps = (f"{step(values[a], values[b])} {b}" for a, b in pairwise(names))
    return " ".join([names[0], *steps])


def step(one: np.ndarray, other: np.ndarray) -> str:
    """Whether the first's values are above the second's (``>``), below (``<``) or neither (``=``)."""
    apart = Spread.of(one - other)
    if not np.isfinite(apart.half) or abs(apart.mean) <= apart.half:
        return "="
    return ">" if apart.mean > 0 else "<"
