"""Bounded least squares from normal equations."""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack
from scipy.optimize import lsq_linear

from .normal_equations import Normal

_RIDGE = 1e-7  # of each unknown's own information
_OPEN_TOLERANCE = 1e-12


def solve(
    equations: Normal,
    lower: np.ndarray | float = -np.inf,
    upper: np.ndarray | float = np.inf,
    damping: float = 0.0,
) -> np.ndarray:
    """Return unknowns (C,) that minimise the squared residual within bounds.

    Args:
        equations: normal equations.
        lower, upper: bounds (C,); none by default.
        damping: Levenberg-Marquardt factor on the diagonal.
    """
    count = len(equations.right)
    if count == 0:
        return np.zeros(0)
    diagonal = equations.gram.diagonal()
    seen = diagonal > 0.0
    size = np.sqrt(np.where(seen, diagonal, 1.0))
    scale = seen / size
    gram = equations.gram * scale[:, None] * scale[None, :]
    right = equations.right * scale
    # a small ridge keeps combinations that the data do not see where they are
    gram[np.diag_indices(count)] += damping * seen + _RIDGE
    root, free, failed = lapack.dposv(gram, right, lower=True)
    if failed:  # sums that were taken off each other may be below nothing by rounding
        gram -= 2.0 * np.linalg.eigvalsh(gram)[0] * np.eye(count)
        root, free, _ = lapack.dposv(gram, right, lower=True)
    low, high = np.where(seen, lower * size, -np.inf), np.where(seen, upper * size, np.inf)
    if (free < low).any() or (free > high).any():
        held = ~(high > low)
        high = np.where(held, low, high)
        high[held] += _OPEN_TOLERANCE * np.maximum(1.0, np.abs(low[held]))  # solvers want an interval
        free = _at_bounds(gram, right, free, low, high)
        if free is None:
            root = np.tril(root)
            target, _ = lapack.dtrtrs(root, right, lower=True)
            free = lsq_linear(root.T, target, bounds=(low, high), method="bvls").x
    return free * scale


def _at_bounds(
    gram: np.ndarray, right: np.ndarray, free: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray | None:
    """Return the solution if it has at their bounds just those unknowns that violate them without bounds;
    otherwise None.

    A general solver takes twenty times as long, and most sets of effects have one unknown at a bound.
    """
    out = np.clip(free, low, high)
    fixed = out != free
    inside = ~fixed
    if inside.any():
        rest = right[inside] - gram[np.ix_(inside, fixed)] @ out[fixed]
        _, out[inside], failed = lapack.dposv(gram[np.ix_(inside, inside)], rest, lower=True)
        if failed or (out[inside] < low[inside]).any() or (out[inside] > high[inside]).any():
            return None
    slope = gram[fixed] @ out - right[fixed]  # of the squared residual, which must fall beyond the bound
    return out if np.all(np.where(free[fixed] < out[fixed], slope, -slope) >= 0.0) else None
