"""Power balance: velocity terms neither make nor take energy."""

from __future__ import annotations

import numpy as np

from workbench.core import Check
from workbench.effects import Plant
from workbench.s3n import reduced

from .states import moving
from .subject import Subject

_STEP = 1e-5  # s: error of the central difference is its square


def power_checks(subject: Subject) -> list[Check]:
    """v' (dM/dt v / 2 - bias) = 0 of every variant in MuJoCo, relative to the power of the velocity terms."""
    worst = max(_imbalance(subject, plant) for plant in subject.plants.values())
    return [
        Check(
            "power_balance",
            worst,
            1e-6,
            "",
            "energy, work",
            "the velocity terms do not belong to the mass matrix: the variant would make or lose energy",
        )
    ]


def _imbalance(subject: Subject, plant: Plant) -> float:
    q, v = subject.states.position, subject.states.velocity
    ahead, behind = (reduced(plant, q + s * _STEP * v, v).mass for s in (1.0, -1.0))
    rate = (ahead - behind) / (2.0 * _STEP)
    bias = reduced(plant, q, v).bias
    made = np.einsum("ki,kij,kj->k", v, rate, v) / 2.0 - np.einsum("ki,ki->k", v, bias)
    least = moving(reduced(plant, q, v).mass, v) * np.abs(v).max()
    scale = max(np.abs(v * bias).sum(axis=1).max(), least)
    return float(np.abs(made).max() / scale) if scale > 0 else float(np.abs(made).max())
