"""The velocity of a robot's base by legs and accelerometer together, as estimators on robots have it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import Recording
from workbench.gait import Limbs, velocity_by_foot

_LEG_NOISE, _LANDING_NOISE, _LANDING_S = 0.1, 1.0, 0.02  # m/s; s after a foot came down
_DRIFT = 0.01  # m/s^2 per square root of a second: how an accelerometer's bias wanders


def with_filtered_velocity(
    limbs: Limbs, recording: Recording, radius: float, acceleration: np.ndarray, noise: float
) -> Recording:
    """Return a recording whose ``base_velocity`` is that of a Kalman filter of legs and accelerometer.

    Its state is the velocity of the base and the accelerometer's bias. Between rows it follows the
    accelerometer; every foot that stands corrects it (see `with_leg_odometry`), less in the first 20 ms after
    it came down, when it may slip.

    Args:
        limbs: the robot's legs.
        recording: as `with_leg_odometry` takes it.
        radius: of the feet [m].
        acceleration: of the base in the world, as measured, without gravity (N, 3) [m/s^2].
        noise: standard deviation of a row of it [m/s^2].
    """
    step, eye, nothing = recording.period, np.eye(3), np.zeros((3, 3))
    forward = np.block([[eye, -step * eye], [nothing, eye]])
    wander = np.block([[eye * (noise * step) ** 2, nothing], [nothing, eye * _DRIFT**2 * step]])
    observed = np.hstack([eye, nothing])
    state, spread = np.zeros(6), np.eye(6)
    since, seen = np.zeros(len(limbs.legs)), np.zeros((len(recording), 3))
    for row, each in enumerate(velocity_by_foot(limbs, recording, radius)):
        if row:
            state = forward @ state + np.concatenate([step * acceleration[row - 1], np.zeros(3)])
            spread = forward @ spread @ forward.T + wander
        stands = np.isfinite(each[:, 0])
        since = np.where(stands, since + step, 0.0)
        for foot in np.flatnonzero(stands):
            size = _LANDING_NOISE if since[foot] < _LANDING_S else _LEG_NOISE
            gain = spread @ observed.T @ np.linalg.inv(spread[:3, :3] + size**2 * eye)
            state = state + gain @ (each[foot] - state[:3])
            spread = spread - gain @ observed @ spread
        seen[row] = state[:3]
    return replace(recording, extra={**recording.extra, "base_velocity": seen})
