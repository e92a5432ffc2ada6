"""A motion that effects can be evaluated on: positions, speeds, accelerations, torques, all at rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.models import Placement


@dataclass(frozen=True)
class Motion:
    """N rows of n axes in actuator coordinates, SI, uniform step `step` [s].

    Attributes:
        position, velocity, acceleration: (N, n).
        torque: motor torque at the tap of ``torque_measured``, the mean over the row's step, (N, n).
        command: ``torque_command`` as it stands at each row, (N, n); the chain's delay not applied.
        delay: the chain's delay [s].
        gain: the chain's gain behind the tap, (n,).
        transmission: J with q_p = J q_s, (n, n).
        kinematics: site name -> Jacobian of the site's world position with respect to q_p, (N, 3, n).
        gravity: (3,) [m/s^2].
        axis_units: ``rad`` or ``m`` per axis.
    """

    step: float
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    command: np.ndarray
    delay: float
    gain: np.ndarray
    transmission: np.ndarray
    kinematics: Callable[[str], np.ndarray]
    gravity: np.ndarray
    axis_units: tuple[str, ...]

    def along(self, place: Placement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, speed and acceleration (N,) of the coordinate that a placement names."""
        row = place.row @ np.linalg.inv(self.transmission)
        return self.position @ row, self.velocity @ row, self.acceleration @ row


def held(command: np.ndarray, step: float, delay: float) -> tuple[np.ndarray, np.ndarray]:
    """A command that is held from row to row, seen through a pure delay.

    Args:
        command: value from each row until the next, (..., N, n); zero before the first row.
        step: row step [s].
        delay: [s], not negative; any fraction of a step.

    Returns:
        ``(at, mean)``, each like `command`: the torque just after each row's time, and its mean over
        the step that follows (which gives a held torque's impulse exactly).
    """
    steps = delay / step
    whole = int(np.floor(steps + 1e-9))
    fraction = max(steps - whole, 0.0) if steps - whole > 1e-9 else 0.0
    newer = _shift(command, whole)
    if fraction == 0.0:
        return newer, newer
    older = _shift(command, whole + 1)
    return older, (1.0 - fraction) * newer + fraction * older


def _shift(values: np.ndarray, rows: int) -> np.ndarray:
    if rows == 0:
        return values
    out = np.zeros_like(values)
    out[..., rows:, :] = values[..., :-rows, :]
    return out
