"""Coordinates in which a feedforward was logged."""

from __future__ import annotations

import numpy as np

from workbench.core import Controller, Recording
from workbench.inspection.law import feedback, ticks

_TELLING = ("torque_command", "velocity", "position_reference")
_TOLD = 0.5  # times what the other reading leaves of the command


def feedforward_of_drives(recording: Recording, controller: Controller, transmission: np.ndarray) -> bool:
    """Return whether a log in joint coordinates has drives' feedforward, if loops may add it there.

    The logged command tells: it is the law of what was read at a tick, and the feedforward. Where it was not
    logged, or says nothing, the feedforward is in the log's own coordinates as all else is.

    Args:
        recording: with a feedforward.
        controller: its loop.
        transmission: J with q_p = J q_s, (n, n).
    """
    told = all(recording.get(name) is not None for name in _TELLING)
    if recording.coordinates == "actuator" or controller.kind != "pd" or not told:
        return False
    rows_a_tick = max(1, round((controller.period_s or recording.period) / recording.period))
    t = ticks(recording, rows_a_tick, phase=0)
    to_controller = np.eye(len(transmission)) if controller.coordinates == "joint" else transmission
    rest = t.command - feedback(t, controller, to_controller)
    own, drives = (np.mean((rest - f) ** 2) for f in (t.feedforward, t.feedforward @ transmission))
    return bool(drives < _TOLD**2 * own)
