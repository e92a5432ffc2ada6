"""Velocity of the base as legs show it: feet that carry load do not slip, so the base moves against them."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from workbench.core import Recording

from .swing import LOADED, Limbs, check


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
    for row, each in enumerate(velocity_by_foot(limbs, recording, radius)):
        stands = np.isfinite(each[:, 0])
        seen[row] = each[stands].mean(axis=0) if stands.any() else seen[row - 1]
    return replace(recording, extra={**recording.extra, "base_velocity": seen})


def velocity_by_foot(limbs: Limbs, recording: Recording, radius: float) -> np.ndarray:
    """Return the velocity of the base by each foot (N, F, 3) [m/s], NaN where it does not stand.

    Arguments are those of `with_leg_odometry`.
    """
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
