"""Divergence: how far trajectories of nearly equal models move apart."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from ..data import Data
from ..hypothesis import Fit, Hypothesis, applied_effect


def divergence(found: Fit, data: Data) -> np.ndarray:
    """Return the median squared distance of trajectories whose parameters differ within their intervals, (R,
    2, n).

    With backlash, trajectories follow their parameters for a while only: soon even the true parameters give
    another motion than the measured one, and no fit can leave less than the distance of two such runs. At an
    end of the interval a run may move to another motion altogether; the median of all pairs ignores that.

    Args:
        found: the fit; its model ran.
        data: recordings.

    Returns:
        Per recording, (R, 2, n); zero where fewer than two of the runs are finite.
    """
    runs = [found.simulated, *data.run([h.model for h in _around(found.hypothesis)])]
    apart = []
    for one, other in combinations(runs, 2):
        rows = [
            data.residual(i, a) - data.residual(i, b) for i, (a, b) in enumerate(zip(one, other, strict=True))
        ]
        square = np.stack([np.mean(r**2, axis=0) for r in rows])
        if np.isfinite(square).all():
            apart.append(square)
    return np.median(apart, axis=0) if apart else np.zeros_like(found.mean_squares)


def _around(hypothesis: Hypothesis) -> list[Hypothesis]:
    """Return models with each parameter of each effect at either end of its interval."""
    out = []
    for k, applied in enumerate(hypothesis.free):
        for name, estimate in applied.parameters.items():
            for deviations in (-1.96, 1.96):
                values = {**applied.values, name: estimate.value + deviations * estimate.std}
                other = applied_effect(hypothesis.base, applied, values)
                out.append(replace(hypothesis, free=(*hypothesis.free[:k], other, *hypothesis.free[k + 1 :])))
    return out
