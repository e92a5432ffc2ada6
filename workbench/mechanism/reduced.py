"""What a closed chain is in a posture: its equation of motion, and what is a dead point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Reduced:
    """Equation of motion in n coordinates: ``mass @ a + bias = gravity + torque``.

    A coordinate along a line has kg and N in place of kg m^2 and N m.

    Attributes:
        mass: (n, n) [kg m^2].
        bias: Coriolis and centrifugal torque (n,) [N m].
        gravity: torque of gravity (n,) [N m].
    """

    mass: np.ndarray
    bias: np.ndarray
    gravity: np.ndarray


def ratio(matrix: np.ndarray) -> float:
    """Return the smallest over the largest singular value of a matrix, 0 of one that is zero."""
    values = np.linalg.svd(matrix, compute_uv=False)
    return float(values[-1] / values[0]) if values[0] > 0.0 else 0.0
