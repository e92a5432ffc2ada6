"""Bounded least squares from normal equations."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular
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
    diagonal = np.diag(equations.gram)
    scale = np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
    gram = equations.gram * scale[:, None] * scale[None, :]
    right = equations.right * scale
    # a small ridge keeps combinations that the data do not see where they are
    gram = gram + np.diag(damping * np.diag(gram) + _RIDGE)
    try:
        root = np.linalg.cholesky(gram)
    except np.linalg.LinAlgError:  # sums that were taken off each other may be below nothing by rounding
        root = np.linalg.cholesky(gram - 2.0 * np.linalg.eigvalsh(gram)[0] * np.eye(count))
    target = solve_triangular(root, right, lower=True)
    free = solve_triangular(root.T, target, lower=False)
    with np.errstate(divide="ignore", invalid="ignore"):
        low = np.where(scale > 0, lower / np.where(scale > 0, scale, 1.0), -np.inf)
        high = np.where(scale > 0, upper / np.where(scale > 0, scale, 1.0), np.inf)
    if np.any(free < low) or np.any(free > high):
        held = ~(high > low)
        high = np.where(held, low, high)
        high[held] += _OPEN_TOLERANCE * np.maximum(1.0, np.abs(low[held]))  # solvers want an interval
        free = lsq_linear(root.T, target, bounds=(low, high), method="bvls").x
    return free * scale
