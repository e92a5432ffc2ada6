"""How the bodies of a serial tree move along a track."""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from workbench.effects import LinkMotion, Plant

from .trajectory import Track, joint_columns

_STRIDE = 4  # rows; smooth between them


def link_motions(plant: Plant, track: Track, step: float) -> list[LinkMotion]:
    """Motion of the body of each serial joint along a track with rows `step` [s] apart."""
    m, model = plant.mujoco, plant.model
    data, n, count = mujoco.MjData(m), model.size, len(track.position)
    back = np.linalg.inv(model.transmission)
    joints = track.position @ back.T
    qpos, dofs = joint_columns(m, model.joints)
    bodies = [int(m.joint(name).bodyid[0]) for name in model.joints]
    rows = np.unique(np.append(np.arange(0, count, _STRIDE), count - 1))
    slopes, frames = np.empty((len(bodies), len(rows), 2, 3, n)), np.empty((len(bodies), len(rows), 3, 3))
    full = np.zeros((2, 3, m.nv))
    for k, row in enumerate(rows):
        data.qpos[qpos] = joints[row]
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        for i, body in enumerate(bodies):
            mujoco.mj_jacBody(m, data, full[0], full[1], body)
            slopes[i, k], frames[i, k] = full[:, :, dofs], data.xmat[body].reshape(3, 3)
    every, out = np.arange(count), []
    for own, frame in zip(slopes, frames, strict=True):
        spline = CubicSpline(rows, own @ back)
        dense, slope = spline(every), spline(every, 1) / step
        change = np.einsum("kaij,kj->kai", dense, track.acceleration)
        change += np.einsum("kaij,kj->kai", slope, track.velocity)
        rotation = CubicSpline(rows, frame)(every)
        out.append(LinkMotion(dense[:, 0], dense[:, 1], rotation, change[:, 0], change[:, 1]))
    return out
