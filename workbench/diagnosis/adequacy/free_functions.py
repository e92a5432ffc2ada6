"""Test of a law against free smooth functions, in its place and beside it, on blocks that were left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..fitting.left_out import LeftOut, left_out
from ..fitting.normal_equations import jackknife, normal, total
from ..policy import POLICY

_BLOCKS = 10  # of all rows, each left out in turn
_PENALTIES = np.logspace(-4, 4, 9)  # of a free function, times the mean of its normal equations' diagonal
Free = tuple[np.ndarray, np.ndarray]  # columns of a free function, and its penalty
InPlace = tuple[Free, np.ndarray]  # the same, and the part of the laws that it stands in for


@dataclass(frozen=True)
class Adequacy:
    """The result of testing an effect against free functions.

    Attributes:
        share: of what a free function of the law's own quantities, or the law with a size that varies freely,
            explains on blocks left out, what it does.
        size: the least over free functions of other quantities beside it of its size, less as many standard
            deviations of that as are significant; 1 is the size that was fitted.
        spread: the largest change of its size beside them.
        basic: whether every drive has what the law says: inertia, damping, Coulomb friction.
    """

    share: float
    size: float
    spread: float
    basic: bool = False

    @property
    def variation(self) -> float:
        """Return by how much of itself (rms) the size varies, as far as a free function explains more."""
        return float(np.sqrt(max(1.0 - self.share, 0.0) / max(self.share, 1e-12)))

    @property
    def is_adequate(self) -> bool:
        """Return whether the effect is certain, whatever else is missing."""
        return self.share >= (POLICY.basic_law if self.basic else POLICY.explained) and self.size > 0.0


def against_free_functions(
    laws: np.ndarray, rest: np.ndarray, free: Sequence[InPlace], beside: Sequence[Free], recording: np.ndarray
) -> Adequacy:
    """Return the adequacy of the first of some laws, against free functions in its place and beside it."""
    sizes = [_size(laws, rest, x) for x in beside]
    each = [_size(laws[rows], rest[rows]) for rows in (recording == i for i in np.unique(recording))]
    # one that turns a single way cannot tell friction from a constant: it says nothing of the size
    told = [size for size, std in each if POLICY.significant * std < 1.0]
    return Adequacy(
        min(_share(f, part, rest) for f, part in free),
        min([*(size - POLICY.significant * std for size, std in sizes), *told], default=0.0),
        max((abs(size - 1.0) for size, _ in sizes), default=0.0),
    )


def _share(free: Free, law: np.ndarray, rest: np.ndarray) -> float:
    """The share that laws explain divided by the share that a free function explains, on left-out blocks."""
    residual = law + rest
    whole = float(residual @ residual)
    most = 1.0 - _left_out(free[0], residual, free[1], 0).left / whole
    return float(np.clip((1.0 - float(rest @ rest) / whole) / max(most, 1e-12), 0.0, 1.0))


def _size(laws: np.ndarray, rest: np.ndarray, beside: Free | None = None) -> tuple[float, float]:
    """The size of the first law relative to its fit, and its deviation, with a free function beside it."""
    count, free, penalty = laws.shape[1], np.zeros((len(rest), 0)), np.zeros((0, 0))
    if beside is not None:
        free, penalty = beside
        free = free - free.mean(axis=0)
    whole = np.zeros((count + free.shape[1],) * 2)
    whole[count:, count:] = penalty
    sizes = _left_out(np.hstack([laws, free]), rest + laws.sum(axis=1), whole, count).each[:, 0]
    return float(sizes.mean()), float(jackknife(sizes))


def _left_out(basis: np.ndarray, torque: np.ndarray, penalty: np.ndarray, first: int) -> LeftOut:
    """Return the fit of columns with each block left out in turn; columns from `first` on are penalised."""
    block = np.arange(len(torque)) * _BLOCKS // len(torque)
    blocks = [normal(basis[block == b], torque[block == b]) for b in range(_BLOCKS)]
    own = np.diag(total(blocks).gram)
    scale = float(np.mean(own[first:])) if len(own) > first else 0.0
    weights = _PENALTIES * scale if scale > 0.0 else np.zeros(1)
    return left_out(blocks, penalty, weights, ridge=1e-9 * np.diag(own + 1e-300))
