"""Rows at which the lacking torque is known: away from the ends, and where no dry friction may hold."""

from __future__ import annotations

import numpy as np

from workbench.effects import Plant
from workbench.models import axis_tendon

_EDGE_S = 0.1  # where differentiating errs
_STILL = 0.02  # of the rms speed: slower is rest


def edge_rows(count: int, step: float) -> int:
    """Return how many rows at either end of a recording have no sure acceleration; `step` in s."""
    return min(count // 10, int(_EDGE_S / step))


def known_rows(plant: Plant, velocity: np.ndarray, step: float) -> np.ndarray:
    """Return where the torque that drives lack is known, (N, n).

    Friction at rest is whatever keeps a coordinate there, up to its size. At a pin it holds every drive that
    turns it.

    Args:
        plant: the model with its dry friction.
        velocity: of the drives, (N, n).
        step: of the rows [s].
    """
    made, edge = plant.mujoco, edge_rows(len(velocity), step)
    by_state = {term.tendon for term in plant.chain.friction}
    rows = {"actuator": np.eye(velocity.shape[1]), "joint": np.linalg.inv(plant.model.transmission)}
    known = np.ones(velocity.shape, bool)
    known[:edge], known[len(known) - edge :] = False, False
    for location, coordinates in rows.items():
        for index, row in enumerate(coordinates):
            name = axis_tendon(index, location)
            if name not in by_state and not made.tendon_frictionloss[made.tendon(name).id]:
                continue
            speed = np.abs(velocity @ row)
            moves = speed > _STILL * np.sqrt(np.mean(speed**2))
            known[:, np.abs(row) > 1e-12] &= moves[:, None]
    return known
