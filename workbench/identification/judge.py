"""Whether a fitted model is enough: what it leaves, held against what noise leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from workbench.frf.response import Frf
from workbench.frf.statistics import expected_distance

_LEVEL = 1e-3  # chance of calling a true model inadequate, for each of the two tests


@dataclass(frozen=True)
class Judgement:
    """Size and whiteness of weighted residuals.

    Attributes:
        cost: sum over lines of d^H C^-1 d, with the measured covariances.
        expected, std: mean and deviation of a true model's cost, few residuals behind C allowed for.
        correlation: of the residuals from line to line.
        correlation_std: its deviation for a true model, about zero.
        size_fine, white: whether each passes at the 0.1 % level.
    """

    cost: float
    expected: float
    std: float
    correlation: float
    correlation_std: float
    size_fine: bool
    white: bool

    @property
    def adequate(self) -> bool:
        """Return whether noise is all that is left."""
        return self.size_fine and self.white

    @property
    def sentence(self) -> str:
        """What a person should know."""
        left = f"the residual is {self.cost / self.expected:.3g} times what noise alone gives"
        if self.adequate:
            return f"The model fits: {left}, and no pattern over frequency remains."
        along = (
            ""
            if self.white
            else f", and a pattern over frequency remains (correlation {self.correlation:.2f})"
        )
        return f"The model is too simple, or the machine is not linear: {left}{along}."


def judge(rest: Sequence[np.ndarray], used: Sequence[Frf], measured: Sequence[Frf], count: int) -> Judgement:
    """Judge what is left of one or several responses.

    Args:
        rest: weighted residuals of each, (F, m).
        used: the responses with the covariances that weighted them.
        measured: the same as measured, before neighbouring lines were pooled.
        count: parameters fitted.
    """
    cost = float(sum(np.sum(np.abs(r) ** 2) for r in rest))
    mean = variance = 0.0
    for frf, original in zip(used, measured, strict=True):
        own, scatter = expected_distance(frf.covariance.shape[1], frf.dof, frf.wishart_size)
        total = float(np.sum(own))
        # lines that share residuals share the error of their covariance, too
        shared = total**2 / float(np.sum(original.fresh) * original.wishart_size)
        mean += total
        variance += float(np.sum(scatter)) + shared
    numbers = 2 * sum(r.size for r in rest)
    expected, std = mean * (1 - count / numbers), float(np.sqrt(variance))
    cross = sum(float(np.real(np.sum(r[1:] * r[:-1].conj()))) for r in rest)
    correlation = cross / max(cost, 1e-300)
    spread = 1.0 / np.sqrt(numbers)
    # parameters that were fitted to the residuals pull their correlation a little below zero
    bias = count / numbers
    return Judgement(
        cost=cost,
        expected=expected,
        std=std,
        correlation=correlation,
        correlation_std=float(spread),
        size_fine=bool(cost < expected + scipy.stats.norm.isf(_LEVEL) * std),
        white=bool(abs(correlation) < scipy.stats.norm.isf(_LEVEL / 2) * spread + bias),
    )
