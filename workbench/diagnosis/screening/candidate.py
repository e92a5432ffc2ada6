"""A candidate: an effect in a place, with the error that it is predicted to leave."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from workbench.core import EffectKey


@dataclass(frozen=True)
class Candidate:
    """An effect in a place with its first estimate.

    Attributes:
        key: which, where.
        coefficients: linear coefficients, (k,).
        shape: nonlinear parameters.
        test_loss: predicted weighted mean square on data that were not fitted.
        beside: nonlinear parameters of the model's own effects, when this one is added.
        others: the same effect in its other forms: what a linearisation shows of a large change need not tell
            which of them it was.
    """

    key: EffectKey
    coefficients: np.ndarray
    shape: Mapping[str, float]
    test_loss: float
    beside: Mapping[EffectKey, Mapping[str, float]] = field(default_factory=dict)
    others: tuple[Candidate, ...] = ()
