"""A mass on the trunk of a compiled machine."""

from __future__ import annotations

import mujoco
import numpy as np


def loaded(m: mujoco.MjModel, mass: float) -> mujoco.MjModel:
    """Return a copy of a compiled machine with a point mass [kg] at the origin of its trunk."""
    made = m.__copy__()
    body = int(m.jnt_bodyid[0])
    own, at, turn = m.body_mass[body], m.body_ipos[body], np.zeros(9)
    mujoco.mju_quat2Mat(turn, m.body_iquat[body])
    turn = turn.reshape(3, 3)
    inertia = turn @ np.diag(m.body_inertia[body]) @ turn.T
    share = own * mass / (own + mass)  # of two masses about their common centre
    inertia += share * (at @ at * np.eye(3) - np.outer(at, at))
    size, axes = np.linalg.eigh(inertia)
    axes[:, 0] *= np.linalg.det(axes)
    made.body_mass[body], made.body_ipos[body] = own + mass, at * own / (own + mass)
    made.body_inertia[body] = size
    mujoco.mju_mat2Quat(made.body_iquat[body], axes.ravel())
    mujoco.mj_setConst(made, mujoco.MjData(made))
    return made
