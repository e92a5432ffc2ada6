"""What jumps of the hardware and of a simulator have in common: a policy's, one after the other.

All runs follow one command, so that rows at the same time are at the same point of a jump.
"""

from __future__ import annotations

import numpy as np
from trained_jump import PERIOD_S
from transfer_measures import rms
from transfer_runs import Made

from workbench.core import Recording
from workbench.training.machine import STEP_S
from workbench.training.rollout import HOLD_S

JUMPS = 3
#: Measure -> unit; means over the jumps.
JUMPED = {
    "apex": "mm",
    "take-off speed": "%",
    "time in the air": "ms",
    "joint angles over the jump": "mrad",
    "torque over the jump": "N m",
    "foot force over the jump": "N",
}
_LOADED = 1.0  # N on all feet together


def jump_gaps(hardware: Made, other: Made) -> dict[str, float]:
    """Sizes of the gaps, `JUMPED`; NaN where one of them fell."""
    if hardware.fell_s is not None or other.fell_s is not None:
        return dict.fromkeys(JUMPED, np.nan)
    one, two = (_jumps(made.recording) for made in (hardware, other))
    (apex, speed, air), (higher, faster, longer) = (jump_numbers(x) for x in (one, two))
    angles, torque, force = (
        rms(two[name].mean(axis=0) - one[name].mean(axis=0)) for name in ("position", "torque", "force")
    )
    return {
        "apex": 1e3 * abs(higher - apex),
        "take-off speed": 100.0 * abs(faster / speed - 1.0),
        "time in the air": 1e3 * abs(longer - air),
        "joint angles over the jump": 1e3 * angles,
        "torque over the jump": torque,
        "foot force over the jump": force,
    }


def jump_numbers(jumps: dict[str, np.ndarray]) -> tuple[float, float, float]:
    """Apex of the trunk [m], its largest upward speed [m/s] and the time without load [s], means."""
    flies = jumps["force"].reshape(*jumps["force"].shape[:2], -1, 3)
    flies = np.linalg.norm(flies, axis=-1).sum(axis=-1) < _LOADED
    tops = jumps["height"].max(axis=1), jumps["rate"].max(axis=1), STEP_S * flies.sum(axis=1)
    apex, speed, air = (float(x.mean()) for x in tops)
    return apex, speed, air


def _jumps(recording: Recording) -> dict[str, np.ndarray]:
    """Signals of every jump (J, T, ...)."""
    rows, first = round(PERIOD_S / STEP_S), round(HOLD_S / STEP_S)
    count = (len(recording) - first) // rows
    signals = {
        "height": recording.extra["base_position"][:, 2],
        "rate": recording.extra["base_velocity"][:, 2],
        "force": recording.extra["ground_force"],
        "position": recording.signals["position"],
        "torque": recording.signals["torque_measured"],
    }
    return {k: x[first : first + count * rows].reshape(count, rows, *x.shape[1:]) for k, x in signals.items()}
