"""The frequency band in which a measured motion shows the torque that it needs; above it, differentiated
noise dominates.
"""

from __future__ import annotations

import numpy as np

from workbench.core import Recording
from workbench.effects import Plant
from workbench.recordings import NoiseLevels
from workbench.simulation import Track, rigid_torque, scored_torque

from .inverse import cutoff_hz

_SHARE = 0.02  # of a torque's root mean square that the acceleration's noise may make
_LEAST_HZ = 2.0
_LINES = 400


def corner_hz(recording: Recording, plant: Plant, levels: NoiseLevels) -> float:
    """Return the corner [Hz] of the filter on both torques: `cutoff_hz`, or less where noise would dominate.

    The acceleration is the fused position differentiated twice, white noise of position sigma_q and velocity
    sigma_w giving it the density omega^4 / (1 / sigma_q^2 + omega^2 / sigma_w^2).
    """
    widest = cutoff_hz(recording)
    name = scored_torque(recording)
    assert name is not None
    n = plant.model.size
    to_actuator = recording.to_actuator(plant.model.transmission)
    torque = np.sqrt(np.mean((recording.signals[name] @ np.linalg.inv(to_actuator)) ** 2, axis=0))
    f = np.linspace(0.0, widest, _LINES + 1)[1:]
    omega = 2.0 * np.pi * f[:, None]
    q = np.maximum(np.nan_to_num(levels.position_std), 1e-15)
    w = np.where(
        np.isfinite(levels.velocity_std), np.maximum(np.nan_to_num(levels.velocity_std), 1e-15), np.inf
    )
    if "velocity" in recording.derived:
        w = np.full(n, np.inf)
    density = omega**4 / (1.0 / q**2 + omega**2 / w**2) * 2.0 * recording.period
    variance = np.cumsum(density, axis=0) * (f[1] - f[0])
    row = len(recording) // 2
    still = np.zeros((1, n))
    middle = recording.position[row : row + 1] @ to_actuator.T
    inertia = np.stack(
        [_needed(plant, middle, still + unit) - _needed(plant, middle, still) for unit in np.eye(n)], axis=-1
    )
    noise = np.sqrt(variance @ (to_actuator.T**2) @ (inertia.T**2))
    fine = np.all(noise <= _SHARE * torque, axis=1)
    return float(max(f[fine].max(initial=0.0), min(_LEAST_HZ, widest)))


def _needed(plant: Plant, position: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    track = Track(position, np.zeros_like(position), acceleration)
    return (rigid_torque(plant, track) @ np.linalg.inv(plant.model.transmission))[0]
