"""Test of a law against free smooth functions, in its place and beside it, on blocks that were left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..policy import POLICY

_BLOCKS = 10  # of all rows, each left out in turn
_PENALTIES = np.logspace(-4, 4, 9)  # of a free function, times the mean of its normal equations' diagonal
Free = tuple[np.ndarray, np.ndarray]  # columns of a free function, and its penalty
InPlace = tuple[Free, np.ndarray]  # the same, and the part of the laws that it stands in for


@dataclass(frozen=True)
class Adequacy:
    """The adequacy of an effect against free functions.

    Attributes:
        share: of what a free function of the law's own quantities, or the law with a size that varies freely,
            explains on blocks left out, what it does.
        size: the least over free functions of other quantities beside it of its size, less as many standard
            deviations of that as are significant; 1 is the size that was fitted.
        spread: the largest change of its size beside them.
    """

    share: float
    size: float
    spread: float

    @property
    def is_adequate(self) -> bool:
        """Whether the effect is certain, whatever else is missing."""
        return self.share >= POLICY.explained and self.size > 0.0


def against_free_functions(
    laws: np.ndarray, rest: np.ndarray, free: Sequence[InPlace], beside: Sequence[Free], recording: np.ndarray
) -> Adequacy:
    """The adequacy of the first of some laws, against free functions in its place and beside it."""
    sizes = [_size(laws, rest, x) for x in beside]
    each = [recording == i for i in np.unique(recording)]
    return Adequacy(
        min(_share(f, part, rest) for f, part in free),
        min(
            *(size - POLICY.significant * std for size, std in sizes),
            *(_size(laws[rows], rest[rows])[0] for rows in each),
        ),
        max((abs(size - 1.0) for size, _ in sizes), default=0.0),
    )


def _share(free: tuple[np.ndarray, np.ndarray], law: np.ndarray, rest: np.ndarray) -> float:
    """The share that laws explain over the share of a free function, on blocks that were left out."""
    residual = law + rest
    whole = float(residual @ residual)
    most = 1.0 - _left_out(free[0], residual, free[1], 0)[1] / whole
    return float(np.clip((1.0 - float(rest @ rest) / whole) / max(most, 1e-12), 0.0, 1.0))


def _size(laws: np.ndarray, rest: np.ndarray, beside: Free | None = None) -> tuple[float, float]:
    """Size of the first law in units of what was fitted, and its deviation, with a free function beside."""
    count, free, penalty = laws.shape[1], np.zeros((len(rest), 0)), np.zeros((0, 0))
    if beside is not None:
        free, penalty = beside
        free = free - free.mean(axis=0)
    whole = np.zeros((count + free.shape[1],) * 2)
    whole[count:, count:] = penalty
    each, _ = _left_out(np.hstack([laws, free]), rest + laws.sum(axis=1), whole, count)
    sizes = each[:, 0]
    deviation = np.sqrt((_BLOCKS - 1) / _BLOCKS * np.sum((sizes - sizes.mean()) ** 2))
    return float(sizes.mean()), float(deviation)


def _left_out(
    basis: np.ndarray, torque: np.ndarray, penalty: np.ndarray, first: int
) -> tuple[np.ndarray, float]:
    """Coefficients with each block left out (B, C), and the squares left there, by the best penalty."""
    block = np.arange(len(torque)) * _BLOCKS // len(torque)
    parts = [basis[block == b] for b in range(_BLOCKS)]
    torques = [torque[block == b] for b in range(_BLOCKS)]
    grams, rights = [p.T @ p for p in parts], [p.T @ t for p, t in zip(parts, torques, strict=True)]
    gram, right = np.sum(grams, axis=0), np.sum(rights, axis=0)
    scale = float(np.mean(np.diag(gram)[first:])) if len(gram) > first else 0.0
    ridge = 1e-9 * np.diag(np.diag(gram) + 1e-300)
    best: tuple[np.ndarray, float] | None = None
    for weight in _PENALTIES * scale if scale > 0.0 else (0.0,):
        left_out = [
            np.linalg.solve(gram - g + weight * penalty + ridge, right - r)
            for g, r in zip(grams, rights, strict=True)
        ]
        left = sum(float(np.sum((t - p @ c) ** 2)) for t, p, c in zip(torques, parts, left_out, strict=True))
        if best is None or left < best[1]:
            best = np.array(left_out), left
    assert best is not None
    return best
