"""Quantities that depend only on the posture, along a track: Jacobians and frames of sites and links."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from workbench.effects import LinkMotion, Plant

from .carried import carried_motion
from .trajectory import Track, joint_columns

_STRIDE = 4  # rows; smooth between them


def site_jacobian(plant: Plant, track: Track, site: str) -> np.ndarray:
    """Return the Jacobian of the world position of a site with respect to q_p along a track, (N, 3, n)."""
    m, full = plant.links, np.zeros((3, plant.links.nv))
    _, dofs = joint_columns(m, plant.model.links[1])
    ident = m.site(site).id

    def of(data: mujoco.MjData, slope: np.ndarray) -> np.ndarray:
        mujoco.mj_jacSite(m, data, full, None, ident)
        return full[:, dofs] @ slope

    return _spline(plant, track, of)(np.arange(len(track.position)))


def link_motions(plant: Plant, track: Track, step: float) -> list[LinkMotion]:
    """Return the motion of the body of each serial joint along a track with rows `step` [s] apart."""
    m, names = plant.links, plant.model.links[1]
    _, dofs = joint_columns(m, names)
    bodies = [int(m.joint(name).bodyid[0]) for name in names]
    full, n = np.zeros((2, 3, m.nv)), plant.model.size

    def of(data: mujoco.MjData, slope: np.ndarray) -> np.ndarray:
        out = np.empty((len(bodies), 3, 2 * n + 3))
        for own, body in zip(out, bodies, strict=True):
            mujoco.mj_jacBody(m, data, full[0], full[1], body)
            own[:, :n], own[:, n : 2 * n] = full[:, :, dofs] @ slope
            own[:, 2 * n :] = data.xmat[body].reshape(3, 3)
        return out

    spline, every = _spline(plant, track, of), np.arange(len(track.position))
    whole, change = spline(every), spline(every, 1) / step
    rise = np.einsum("klij,kj->kli", whole[..., :n], track.acceleration)
    rise += np.einsum("klij,kj->kli", change[..., :n], track.velocity)
    spin = np.einsum("klij,kj->kli", whole[..., n : 2 * n], track.acceleration)
    spin += np.einsum("klij,kj->kli", change[..., n : 2 * n], track.velocity)
    return [
        LinkMotion(
            whole[:, i, :, :n], whole[:, i, :, n : 2 * n], whole[:, i, :, 2 * n :], rise[:, i], spin[:, i]
        )
        for i in range(len(bodies))
    ]


def _spline(plant: Plant, track: Track, of: Callable[[mujoco.MjData, np.ndarray], np.ndarray]) -> CubicSpline:
    """What MuJoCo says of each posture and d q_s / d q_p there, by the number of the row.

    Asked at every fourth row: a cubic spline is right between them, and its slope is as well.
    """
    m, model = plant.links, plant.model
    data, (qpos, _) = mujoco.MjData(m), joint_columns(m, model.links[1])
    rows = np.unique(np.append(np.arange(0, len(track.position), _STRIDE), len(track.position) - 1))
    some = []
    for joints, slope in zip(*_joints(plant, track.position[rows]), strict=True):
        data.qpos[qpos] = joints
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        some.append(of(data, slope).copy())
    return CubicSpline(rows, np.array(some))


def _joints(plant: Plant, drives: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Serial joints (N, n) where the drives (N, n) are, and d q_s / d q_p (N, n, n)."""
    if plant.model.carried is not None:
        at = carried_motion(plant, drives)
        return at.position, at.slope
    back = np.linalg.inv(plant.model.transmission)
    return drives @ back.T, np.broadcast_to(back, (len(drives), *back.shape))
