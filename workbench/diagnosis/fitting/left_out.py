"""Penalised least squares, with the penalty weight chosen on blocks that are left out in turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .normal_equations import Normal, total


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Coefficients of all blocks (C,) and with each block left out (B, C), and the squares left on that
    block.
    """

    whole: np.ndarray
    each: np.ndarray
    left: float


def left_out(
    blocks: Sequence[Normal], penalty: np.ndarray, weights: np.ndarray, ridge: np.ndarray | float = 0.0
) -> LeftOut:
    """Return the solution with the best penalty weight.

    Args:
        blocks: normal equations of blocks of rows.
        penalty: quadratic form of the coefficients, (C, C).
        weights: of it, (W,), of which the best is taken.
        ridge: a quadratic form that is always added.
    """
    all_blocks = total(blocks)
    grams, rights = np.stack([b.gram for b in blocks]), np.stack([b.right for b in blocks])
    priors = weights[:, None, None] * penalty + ridge
    systems = (all_blocks.gram - grams)[None] + priors[:, None]
    each = np.linalg.solve(systems, (all_blocks.right - rights)[None, :, :, None])[..., 0]
    squares = np.array([b.square for b in blocks])
    left = squares - 2.0 * np.sum(rights * each, axis=-1) + np.einsum("wbc,bcd,wbd->wb", each, grams, each)
    best = int(np.argmin(left.sum(axis=1)))
    whole = np.linalg.solve(all_blocks.gram + priors[best], all_blocks.right)
    return LeftOut(whole, each[best], float(left[best].sum()))
