"""Bounded least squares from normal equations."""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from .sensitivity import Normal


def solve(equations: Normal, lower: np.ndarray, upper: np.ndarray, damping: float = 0.0) -> np.ndarray:
    """Unknowns (C,) that minimise the squared residual within bounds.

    Args:
        equations: normal equations.
        lower, upper: bounds (C,).
        damping: Levenberg-Marquardt factor on the diagonal.
    """
    count = len(equations.right)
    if count == 0:
        return np.zeros(0)
    diagonal = np.diag(equations.gram)
    scale = np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
    gram = equations.gram * scale[:, None] * scale[None, :]
    right = equations.right * scale
    # unknowns that the data do not see, and combinations of them, stay where they are
    values, vectors = np.linalg.eigh(gram + damping * np.diag(np.diag(gram)))
    keep = values > 1e-9 * max(values[-1], 1e-300)
    root = vectors[:, keep] * np.sqrt(values[keep])
    target = (vectors[:, keep].T @ right) / np.sqrt(values[keep])
    free = np.linalg.lstsq(root.T, target, rcond=None)[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        low = np.where(scale > 0, lower / np.where(scale > 0, scale, 1.0), -np.inf)
        high = np.where(scale > 0, upper / np.where(scale > 0, scale, 1.0), np.inf)
    if np.any(free < low) or np.any(free > high):
        high = np.where(high > low, high, low + 1e-12)
        free = lsq_linear(root.T, target, bounds=(low, high), method="bvls").x
    return free * scale
