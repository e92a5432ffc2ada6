"""Quantities that depend only on the posture, along a track: Jacobians and frames of sites and links."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from workbench.effects import LinkMotion, Plant

from .carried import carried_motion
from .trajectory import Track, joint_columns

_STRIDE = 4  # rows; smooth between them


def site_motion(plant: Plant, track: Track, step: float, site: str) -> LinkMotion:
    """Return the motion of a site along a track with rows `step` [s] apart."""
    return _motions(plant, track, step, [(mujoco.mj_jacSite, "site_xmat", plant.links.site(site).id)])[0]


def link_motions(plant: Plant, track: Track, step: float) -> list[LinkMotion]:
    """Return the motion of the body of each serial joint along a track with rows `step` [s] apart."""
    bodies = [int(plant.links.joint(name).bodyid[0]) for name in plant.model.links[1]]
    return _motions(plant, track, step, [(mujoco.mj_jacBody, "xmat", body) for body in bodies])


def _motions(
    plant: Plant, track: Track, step: float, frames: Sequence[tuple[Callable[..., None], str, int]]
) -> list[LinkMotion]:
    """Motions of frames: the function of their Jacobians, the array of their rotations, and their number."""
    m, n = plant.links, plant.model.size
    _, dofs = joint_columns(m, plant.model.links[1])
    full = np.zeros((2, 3, m.nv))

    def of(data: mujoco.MjData, slope: np.ndarray) -> np.ndarray:
        out = np.empty((len(frames), 3, 2 * n + 3))
        for own, (jacobians, rotations, number) in zip(out, frames, strict=True):
            jacobians(m, data, full[0], full[1], number)
            own[:, :n], own[:, n : 2 * n] = full[:, :, dofs] @ slope
            own[:, 2 * n :] = getattr(data, rotations)[number].reshape(3, 3)
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
        for i in range(len(frames))
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
