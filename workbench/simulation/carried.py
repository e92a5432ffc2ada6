"""Links that drives carry: what they need, and what effects change of that.

An effect on such a link is put into the tree that the serial joints move. Along the joints' motion that tree
needs more than without it, and the closed chain needs as much more: its links move the same way.
"""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import CarriedMotion
from workbench.effects import Plant

from .native import inverse_forces, mass_matrices
from .trajectory import joint_columns

_NUDGE = 1e-5  # rad, rad/s: central differences of smooth functions


def carried_motion(plant: Plant, position: np.ndarray) -> CarriedMotion:
    """Return the motion of the links that drives carry, at rest at drive positions (N, n)."""
    assert plant.model.carried is not None
    still = np.zeros_like(position)
    return plant.model.carried.at(position, still, still)


def carried_torque(plant: Plant, q: np.ndarray, w: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Return the torque (N, n) that the links need from the drives along their motion."""
    assert plant.model.carried is not None
    at = plant.model.carried.at(q, w, a)
    joints = at.position, at.velocity, at.acceleration
    now, before = (_forces(m, plant.model.links[1], *joints) for m in _trees(plant))
    return np.einsum("kji,kj->ki", at.slope, at.torque + now - before)


def carried_inertia(plant: Plant, q: np.ndarray) -> np.ndarray:
    """Return the inertia of the links in drive coordinates (N, n, n), at positions (N, n)."""
    at, names = carried_motion(plant, q), plant.model.links[1]
    now, before = (_masses(m, names, at.position) for m in _trees(plant))
    return at.slope.transpose(0, 2, 1) @ (at.inertia + now - before) @ at.slope


def carried_slopes(plant: Plant, q: np.ndarray, w: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Return derivatives of `carried_torque` by acceleration, rate and position, (3, N, n, n)."""

    def torque(*at: np.ndarray) -> np.ndarray:
        return carried_torque(plant, *at)

    n, out = q.shape[1], np.empty((3, *q.shape, q.shape[1]))
    out[0] = carried_inertia(plant, q)
    for j, step in enumerate(_NUDGE * np.eye(n)):
        out[1, :, :, j] = (torque(q, w + step, a) - torque(q, w - step, a)) / (2.0 * _NUDGE)
        out[2, :, :, j] = (torque(q + step, w, a) - torque(q - step, w, a)) / (2.0 * _NUDGE)
    return out


def _trees(plant: Plant) -> tuple[mujoco.MjModel, mujoco.MjModel]:
    assert plant.bare is not None
    return plant.links, plant.bare


def _forces(
    m: mujoco.MjModel, names: tuple[str, ...], q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> np.ndarray:
    """Of joints (N, n) along their motion; all others stand still."""
    at, dofs = joint_columns(m, names)
    states, change = np.zeros((len(q), 2, m.nv)), np.zeros((len(q), m.nv))
    states[:, 0] = m.qpos0
    states[:, 0, at], states[:, 1, dofs], change[:, dofs] = q, v, a
    return inverse_forces(m, states, change)[:, dofs]


def _masses(m: mujoco.MjModel, names: tuple[str, ...], q: np.ndarray) -> np.ndarray:
    at, dofs = joint_columns(m, names)
    positions = np.tile(m.qpos0, (len(q), 1))
    positions[:, at] = q
    return mass_matrices(m, positions)[:, dofs[:, None], dofs]
