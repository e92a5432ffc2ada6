"""In which coordinates a feedforward was logged."""

from __future__ import annotations

import numpy as np

from workbench.core import Controller, Recording

_TOLD = 0.5  # times what the other reading leaves of the command


def feedforward_of_drives(recording: Recording, controller: Controller, transmission: np.ndarray) -> bool:
    """Whether a log in joint coordinates has its feedforward in those of the drives, where loops may add it.

    The logged command tells: it is the law of what was read at a tick, and the feedforward. Where it was not
    logged, or says nothing, the feedforward is in the log's own coordinates as all else is.

    Args:
        recording: with a feedforward.
        controller: its loop.
        transmission: J with q_p = J q_s, (n, n).
    """
    command, feedforward = recording.get("torque_command"), recording.signals["torque_feedforward"]
    velocity, reference = recording.get("velocity"), recording.get("position_reference")
    if recording.coordinates == "actuator" or controller.kind != "pd":
        return False
    if command is None or velocity is None or reference is None:
        return False
    rows_a_tick = (controller.period_s or recording.period) / recording.period
    rows = np.unique(np.round(np.arange(0.0, len(recording) - 0.5, max(rows_a_tick, 1.0))).astype(int))
    ticks = rows[recording.valid[rows]]
    sense = np.eye(len(transmission)) if controller.coordinates == "joint" else transmission
    rate = recording.get("velocity_reference")
    wanted = reference - recording.position @ sense.T, (0.0 if rate is None else rate) - velocity @ sense.T
    law = (np.array(controller.kp) * wanted[0] + np.array(controller.kd) * wanted[1]) @ sense
    rest = (command - law)[ticks]
    own, drives = feedforward[ticks], feedforward[ticks] @ transmission
    return bool(np.mean((rest - drives) ** 2) < _TOLD**2 * np.mean((rest - own) ** 2))
