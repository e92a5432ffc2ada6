"""What depends on the posture alone, along a track: Jacobians and frames of sites and links."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from workbench.effects import LinkMotion, Plant

from .trajectory import Track, joint_columns

_STRIDE = 4  # rows; smooth between them


def site_jacobian(plant: Plant, track: Track, site: str) -> np.ndarray:
    """Jacobian of a site's world position with respect to q_p along a track, shape (N, 3, n)."""
    m, full = plant.mujoco, np.zeros((3, plant.mujoco.nv))
    _, dofs = joint_columns(m, plant.model.joints)
    ident = m.site(site).id

    def of(data: mujoco.MjData) -> np.ndarray:
        mujoco.mj_jacSite(m, data, full, None, ident)
        return full[:, dofs]

    return _spline(plant, track, of)(np.arange(len(track.position))) @ np.linalg.inv(plant.model.transmission)


def link_motions(plant: Plant, track: Track, step: float) -> list[LinkMotion]:
    """Motion of the body of each serial joint along a track with rows `step` [s] apart."""
    m, model = plant.mujoco, plant.model
    _, dofs = joint_columns(m, model.joints)
    bodies = [int(m.joint(name).bodyid[0]) for name in model.joints]
    full, back, n = np.zeros((2, 3, m.nv)), np.linalg.inv(model.transmission), model.size

    def of(data: mujoco.MjData) -> np.ndarray:
        out = np.empty((len(bodies), 3, 2 * n + 3))
        for own, body in zip(out, bodies, strict=True):
            mujoco.mj_jacBody(m, data, full[0], full[1], body)
            own[:, :n], own[:, n : 2 * n] = full[:, :, dofs] @ back
            own[:, 2 * n :] = data.xmat[body].reshape(3, 3)
        return out

    spline, every = _spline(plant, track, of), np.arange(len(track.position))
    whole, slope = spline(every), spline(every, 1) / step
    change = np.einsum("klij,kj->kli", whole[..., :n], track.acceleration)
    change += np.einsum("klij,kj->kli", slope[..., :n], track.velocity)
    spin = np.einsum("klij,kj->kli", whole[..., n : 2 * n], track.acceleration)
    spin += np.einsum("klij,kj->kli", slope[..., n : 2 * n], track.velocity)
    return [
        LinkMotion(
            whole[:, i, :, :n], whole[:, i, :, n : 2 * n], whole[:, i, :, 2 * n :], change[:, i], spin[:, i]
        )
        for i in range(len(bodies))
    ]


def _spline(plant: Plant, track: Track, of: Callable[[mujoco.MjData], np.ndarray]) -> CubicSpline:
    """What MuJoCo says of each posture, by the number of the row.

    Asked at every fourth row: a cubic spline is right between them, and its slope is as well.
    """
    m, model = plant.mujoco, plant.model
    data, (qpos, _) = mujoco.MjData(m), joint_columns(m, model.joints)
    joints = track.position @ np.linalg.inv(model.transmission).T
    rows = np.unique(np.append(np.arange(0, len(joints), _STRIDE), len(joints) - 1))
    some = []
    for row in rows:
        data.qpos[qpos] = joints[row]
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        some.append(of(data).copy())
    return CubicSpline(rows, np.array(some))
