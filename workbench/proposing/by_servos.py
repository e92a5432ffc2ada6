"""The controller of a log that position actuators of the model's own file made."""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core import Recording
from workbench.models import Servos

_LEFT = 0.1  # of the torque's deviation, that noise may leave of it


def by_servos(recording: Recording, servos: Servos | None) -> tuple[dict[str, Any], str] | None:
    """Return the ``[controller]`` of these actuators, and why; None if the logged torque is not their law."""
    torque, reference = recording.get("torque_measured"), recording.get("position_reference")
    if servos is None or torque is None or reference is None or recording.coordinates != "joint":
        return None
    law = np.array(servos.kp) * (reference - recording.position) - np.array(servos.kd) * recording.velocity
    rows = recording.valid
    left = (torque - law)[rows].std(axis=0) / np.maximum(torque[rows].std(axis=0), 1e-12)
    if not np.all(left < _LEFT):
        return None
    table: dict[str, Any] = {"kind": "pd", "coordinates": "joint", "kp": [*servos.kp], "kd": [*servos.kd]}
    if servos.step < recording.period * (1.0 - 1e-6):
        table["period_s"] = servos.step
    share = f"{100 * left.max():.2g} % of the torque"
    return table, f"position actuators of the model's file, whose law leaves {share}"


def servos_hint(servos: Servos | None) -> str:
    """Return how to say that these actuators made a log whose torque does not show it."""
    if servos is None:
        return ""
    kp, kd = (",".join(f"{x:g}" for x in gains) for gains in (servos.kp, servos.kd))
    return f"; if the position actuators of the model's file made it, --kp {kp} --kd {kd}"
