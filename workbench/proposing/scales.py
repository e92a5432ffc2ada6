"""Units of time, position and velocity together: tied by the derivative; names and sizes do the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .units import COUNTS_A_SECOND, scale

_SPREAD = 0.012  # by how much a measured factor may miss the right one
_NOISE = 0.3  # of what makes two columns unlike, by which noise and filters pull the factor
_APART = 0.01  # weight of turns a second beside a position in another unit
_FLOOR = 1e-6  # weight of a reading that the factor contradicts


@dataclass(frozen=True)
class UnitGuess:
    """A unit and its confidence."""

    unit: str
    sure: float


@dataclass(frozen=True)
class AxisMotion:
    """Axes with one unit, and its candidates.

    Attributes:
        position, velocity: unit -> weight by statement or size; velocity is empty where there is none.
        factor: velocity over the derivative of position, both in the table's own units; None where unknown.
        likeness: of the two, 0 to 1.
    """

    position: Mapping[str, float]
    velocity: Mapping[str, float]
    factor: float | None
    likeness: float = 0.9


def weigh(
    time: Mapping[str, float], motions: Sequence[AxisMotion]
) -> tuple[UnitGuess, list[dict[str, UnitGuess]]] | None:
    """Return the most likely units: of the clock, and of each group of axes.

    Args:
        time: unit -> weight by name and size.
        motions: the groups.

    Returns:
        Time, and of each group ``position`` and, where there is one, ``velocity``; None where no unit makes
        such numbers likely.
    """
    clocks = list(time)
    readings = [[_readings(t, motion) for t in clocks] for motion in motions]
    sums = np.array([[sum(each.values()) for each in row] for row in readings])
    if not np.all(sums.max(axis=1, initial=0.0) > 0):
        return None
    # each by its largest: many groups that contradict a clock must not come to nothing
    whole = np.array([time[t] for t in clocks]) * np.prod(sums / sums.max(axis=1, keepdims=True), axis=0)
    if not whole.sum() > 0:
        return None
    out = []
    for row, total in zip(readings, sums, strict=True):
        marginal: dict[str, dict[str, float]] = {"position": {}, "velocity": {}}
        for share, each, norm in zip(whole, row, total, strict=True):
            for (p, v), weight in each.items():
                for kind, unit in (("position", p), ("velocity", v)):
                    if unit and norm > 0:
                        marginal[kind][unit] = marginal[kind].get(unit, 0.0) + share * weight / norm
        out.append({kind: _likeliest(weights) for kind, weights in marginal.items() if weights})
    return _likeliest(dict(zip(clocks, whole.tolist(), strict=True))), out


def expected(time: str, position: str, velocity: str) -> float:
    """Return the size of velocity divided by derivative of position in these units."""
    return abs(scale(position, "position") / (scale(time, "time") * scale(velocity, "velocity")))


def _readings(time: str, motion: AxisMotion) -> dict[tuple[str, str], float]:
    """Weight of each pair of units, given the clock's."""
    out = {}
    spread = _SPREAD + _NOISE * (1.0 - motion.likeness)
    for p, wp in motion.position.items():
        for v, wv in (motion.velocity or {"": 1.0}).items():
            # who counts turns of one thing does of the other
            weight = wp * wv * (_APART if v == "turn/s" and p != "turn" else 1.0)
            if v == COUNTS_A_SECOND:
                same = p == "counts" and bool(motion.factor)
                miss = np.log(abs(motion.factor or 1.0) * scale(time, "time")) / spread
                out[p, v] = (
                    weight * (float(np.exp(-0.5 * min(miss * miss, 1400.0))) + _FLOOR) if same else 0.0
                )
                continue
            if v and motion.factor:
                if p == "counts":
                    weight *= _FLOOR**0.5
                else:
                    miss = np.log(abs(motion.factor) / expected(time, p, v)) / spread
                    weight *= float(np.exp(-0.5 * min(miss * miss, 1400.0))) + _FLOOR
            out[p, v] = weight
    return out


def _likeliest(weights: Mapping[str, float]) -> UnitGuess:
    best = max(weights, key=lambda u: weights[u])
    return UnitGuess(best, min(0.999, weights[best] / sum(weights.values())))
