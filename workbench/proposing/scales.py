"""Units of time, position and velocity together: the derivative ties them, names and sizes do the rest."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from .units import is_linear, scale

_SPREAD = 0.04  # by how much a measured factor may miss the right one
_FLOOR = 1e-6  # weight of a reading that the factor contradicts


@dataclass(frozen=True)
class Told:
    """A unit and how sure it is."""

    unit: str
    sure: float


def weigh(
    time: dict[str, float], position: dict[str, float], velocity: dict[str, float], factor: float | None
) -> dict[str, Told]:
    """The likeliest units.

    Args:
        time, position, velocity: unit -> weight by name and size; velocity is empty where there is none.
        factor: velocity over the derivative of position, both in the table's own units; None where unknown.

    Returns:
        ``time``, ``position`` and, where there is one, ``velocity``.
    """
    marginal: dict[str, dict[str, float]] = {"time": {}, "position": {}, "velocity": {}}
    for (t, wt), (p, wp), (v, wv) in product(time.items(), position.items(), (velocity or {"": 1.0}).items()):
        weight = wt * wp * wv
        if v and p != "counts":
            if is_linear(p, "position") != is_linear(v, "velocity"):
                continue
            if factor:
                expected = scale(p, "position") / (scale(t, "time") * scale(v, "velocity"))
                miss = np.log(abs(factor) / expected) / _SPREAD
                weight *= float(np.exp(-0.5 * min(miss * miss, 1400.0))) + _FLOOR
        elif v and factor:
            weight *= _FLOOR**0.5
        for kind, unit in (("time", t), ("position", p), ("velocity", v)):
            marginal[kind][unit] = marginal[kind].get(unit, 0.0) + weight
    out = {}
    for kind, weights in marginal.items():
        total = sum(weights.values())
        if total > 0 and (kind != "velocity" or velocity):
            best = max(weights, key=lambda u: weights[u])
            out[kind] = Told(best, min(0.999, weights[best] / total))
    return out
