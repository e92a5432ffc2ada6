"""What a serial tree leaves out of a parallelogram: equations shared by the structural effects.

All in actuator coordinates of the first two axes: q1 of the thigh, q2 of the shank, alpha = q2 - q1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.models import Crank, Model

from .motion import Motion

#: J of the parallelogram (paper, Eq. 2).
PARALLELOGRAM = np.array([[1.0, 0.0], [1.0, 1.0]])


def is_parallelogram(model: Model) -> bool:
    """Return whether the model states a linkage and drives two joints through the parallelogram's J."""
    return model.linkage is not None and np.array_equal(model.transmission, PARALLELOGRAM)


def crank_of(model: Model) -> Crank:
    """Return the part of the linkage that turns with the drive of the knee, before the pin of the shank."""
    crank = model.linkage.crank if model.linkage is not None else None
    if crank is None or not is_parallelogram(model) or not model.has("linkage_inertia"):
        return Crank()
    return crank if model.has("linkage_gravity") else replace(crank, g2=0.0)


def inertia_columns(motion: Motion) -> np.ndarray:
    """Return minus the torque of M11, M12 cos(alpha) and M22 of 1 kg m^2 each, shape (3, N, 2).

    From the kinetic energy M11 w1^2/2 + M12 cos(alpha) w1 w2 + M22 w2^2/2 (paper, Eq. 16) by Lagrange,
    velocity terms included.
    """
    q, w, a = motion.position, motion.velocity, motion.acceleration
    alpha = q[:, 1] - q[:, 0]
    cos, sin, zero = np.cos(alpha), np.sin(alpha), np.zeros(len(q))
    first = np.stack([a[:, 0], zero], -1)
    coupling = np.stack([cos * a[:, 1] - sin * w[:, 1] ** 2, cos * a[:, 0] + sin * w[:, 0] ** 2], -1)
    second = np.stack([zero, a[:, 1]], -1)
    return -np.stack([first, coupling, second])


def gravity_columns(motion: Motion) -> np.ndarray:
    """Return torque -sin q of 1 N m on each axis, shape (2, N, 2)."""
    sin, zero = np.sin(motion.position), np.zeros(len(motion.position))
    return -np.stack([np.stack([sin[:, 0], zero], -1), np.stack([zero, sin[:, 1]], -1)])
