"""Velocity of the base as legs show it: feet that carry load do not slip, so the base moves against them."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from workbench.core import Recording

from .swing import LOADED, Limbs, check

_LEG_NOISE, _LANDING_NOISE, _LANDING_S = 0.1, 1.0, 0.02  # m/s; s after a foot came down
_DRIFT = 0.01  # m/s^2 per square root of a second: how an accelerometer's bias wanders


def with_leg_odometry(limbs: Limbs, recording: Recording, radius: float) -> Recording:
    """Return a recording whose ``base_velocity`` is that of leg odometry, the mean over the feet that
    stand.

    A foot is a ball that rolls: the point at rest is `radius` under its centre. Taken for a point (0), a ball
    seems to stand still while its centre moves on. Where no foot stands the last velocity is kept.

    Args:
        limbs: the robot's legs.
        recording: as `predict_swing` takes it, with ``ground_force``.
        radius: of the feet [m].
    """
    seen = np.zeros((len(recording), 3))
    for row, each in enumerate(_by_foot(limbs, recording, radius)):
        stands = np.isfinite(each[:, 0])
        seen[row] = each[stands].mean(axis=0) if stands.any() else seen[row - 1]
    return replace(recording, extra={**recording.extra, "base_velocity": seen})


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
    for row, each in enumerate(_by_foot(limbs, recording, radius)):
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


def _by_foot(limbs: Limbs, recording: Recording, radius: float) -> np.ndarray:
    """Velocity of the base by each foot (N, F, 3) [m/s], NaN where it does not stand."""
    check(recording)
    m, data, extra = limbs.m, mujoco.MjData(limbs.m), recording.extra
    back = np.linalg.inv(limbs.transmission).T
    joints, speeds = recording.position @ back, recording.velocity @ back
    force = extra["ground_force"].reshape(len(recording), -1, 3)
    stands = np.linalg.norm(force, axis=-1) > LOADED
    seen, jacobian = np.full(force.shape, np.nan), np.zeros((3, m.nv))
    for row in range(len(recording)):
        data.qpos[3:7], data.qvel[3:6] = extra["base_orientation"][row], extra["base_angular_velocity"][row]
        data.qpos[limbs.places] = limbs.begin @ joints[row]
        data.qvel[limbs.dofs] = limbs.begin @ speeds[row]
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        for k, (foot, _) in enumerate(limbs.legs):
            if stands[row, k]:
                at = data.geom_xpos[foot] - (0.0, 0.0, radius)
                mujoco.mj_jac(m, data, jacobian, None, at, int(m.geom_bodyid[foot]))
                seen[row, k] = -jacobian @ data.qvel
    return seen
