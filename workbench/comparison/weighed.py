"""The part of a torque that a model's weight and inertia leave unexplained, whatever its friction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from workbench.core import Recording
from workbench.effects import Plant, compile_plant
from workbench.models import Model
from workbench.recordings import noise_levels
from workbench.simulation import scored_torque

from .inverse import torque_pair
from .standing import on_ground

_MOST = 4000  # rows of a recording that are looked at
_FEWEST = 200  # rows that count, below which a motion is no evidence


def is_weighable(model: Model, recordings: Sequence[Recording]) -> bool:
    """Whether torque was logged along motions that only the drives and the weight make."""
    return (
        not (model.floats or model.posture_dependent)
        and bool(recordings)
        and all(
            scored_torque(r) is not None and not on_ground(r) and int(r.valid.sum()) >= _FEWEST
            for r in recordings
        )
    )


def torque_left(model: Model, recordings: Sequence[Recording]) -> np.ndarray:
    """Share (n,) of each drive's torque, squared, that the model does not need along the measured motion.

    Friction and an offset of the torque are fitted away: they are what models lack most often, and what a
    wrong sign or unit must not be taken for.

    Raises:
        SimulationError: a model that no body can be.
    """
    return _left(compile_plant(model), recordings)


def _left(plant: Plant, recordings: Sequence[Recording]) -> np.ndarray:
    sums = np.zeros((2, plant.model.size))
    for r in recordings:
        measured, needed, valid = torque_pair(plant, r, None, noise_levels(r))
        logged = r.get("velocity")
        speed = np.gradient(r.position, r.period, axis=0) if logged is None else logged
        speed = speed if r.coordinates == "actuator" else speed @ plant.model.transmission.T
        rows = np.flatnonzero(valid)
        rows = rows[:: max(1, len(rows) // _MOST)]
        for i, (x, y, v) in enumerate(zip(measured[rows].T, needed[rows].T, speed[rows].T, strict=True)):
            one = np.ones_like(v)
            # friction brakes: of the right sign only, else it would stand in for a wrong one
            columns = np.column_stack([one, -one, v, np.sign(v)])
            sums[:, i] += scipy.optimize.nnls(columns, x - y)[1] ** 2, float(x @ x)
    # of a joint without a drive nothing was logged that could be left
    return np.divide(sums[0], sums[1], out=np.zeros(len(sums[0])), where=sums[1] > 0)
