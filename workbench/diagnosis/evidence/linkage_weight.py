"""Cranks and rods whose weight looks like the constant torques that were found at the drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.models import Model

from ..policy import POLICY
from ..search_result import SearchResult

BIAS = "torque_bias"


@dataclass(frozen=True)
class Weight:
    """A body of the linkage, the mass that the file gives it, and that which looks like the torques [kg]."""

    body: str
    mass: float
    instead: float

    def __str__(self) -> str:
        """Return both masses in words."""
        return f"{self.body} ({self.instead:.3g} kg, not {self.mass:.3g})"


def weights_like(found: SearchResult) -> tuple[Weight, ...]:
    """Return bodies that no serial joint carries and whose other mass would look like the torques found.

    Asked in the mean posture of the fitted recordings: a weight changes little about it.
    """
    model, added = found.model, found.final.hypothesis.added
    torque = {a.key.axis: a.values["torque"] for a in added if a.key.effect == BIAS}
    if model.carried is None or not torque:
        return ()
    data = found.start_data
    posture = np.concatenate([r.position[r.valid] for r in data.recordings[: data.training]]).mean(axis=0)
    return _alike(model, np.array([torque.get(axis, 0.0) for axis in model.axes]), posture)


def _alike(model: Model, torque: np.ndarray, posture: np.ndarray) -> tuple[Weight, ...]:
    """Bodies by how well their weight at a posture of the drives (n,) fits torques on them (n,)."""
    assert model.carried is not None
    out: list[tuple[float, Weight]] = []
    for body, (mass, weight) in model.carried.weights(posture).items():
        size = float(np.linalg.norm(weight) * np.linalg.norm(torque))
        alike = abs(float(weight @ torque)) / size if size else 0.0
        # what helps the drive in the model is what they need not hold
        instead = mass - float(weight @ torque) / float(weight @ weight) if size else 0.0
        if alike >= POLICY.weight_alike and 0.0 < instead <= POLICY.weight_most * mass:
            out.append((alike, Weight(body, mass, instead)))
    return tuple(weight for _, weight in sorted(out, key=lambda each: -each[0]))
