"""Positions of the feet along a motion, and the torque of the ground force in the drives."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.effects import Contact, Plant, feet_of
from workbench.simulation import interpolate

_EVERY = 4  # rows: a foot moves smoothly


@dataclass(frozen=True)
class Feet:
    """F feet along N rows of a motion.

    Attributes:
        depth: in the ground, (N, F) [m]; negative in the air.
        normal: of the ground, upward, (N, F, 3), world frame.
        jacobian: world velocity of the point that touches by the drives' speeds, (N, F, 3, n).
    """

    depth: np.ndarray
    normal: np.ndarray
    jacobian: np.ndarray

    @staticmethod
    def along(plant: Plant, position: np.ndarray, every: int = _EVERY) -> Feet:
        """Return the feet of a plant on its ground, for drive positions (N, n).

        They are computed at `every` so many rows, and interpolated in between.
        """
        m = plant.mujoco
        data, feet = mujoco.MjData(m), feet_of(m, plant.contacts)
        rows = np.unique(np.append(np.arange(0, len(position), every), len(position) - 1))
        serial = position[rows] @ np.linalg.inv(plant.model.transmission).T
        joints = plant.state_at(np.stack([serial, serial], axis=1))[:, 0]
        depth, normal = np.zeros((len(rows), len(feet))), np.zeros((len(rows), len(feet), 3))
        jacobian, full = np.zeros((len(rows), len(feet), 3, m.nv)), np.zeros((3, m.nv))
        for k, q in enumerate(joints):
            data.qpos[:] = q
            mujoco.mj_kinematics(m, data)
            mujoco.mj_comPos(m, data)
            for f, (ground, foot) in enumerate(feet):
                depth[k, f] = -mujoco.mj_geomDistance(m, data, ground, foot, 1e3, None)
                normal[k, f] = up = data.geom_xmat[ground].reshape(3, 3)[:, 2]
                height = m.geom_size[ground, 2] if m.geom_type[ground] == mujoco.mjtGeom.mjGEOM_BOX else 0.0
                centre = data.geom_xpos[foot]
                away = float(up @ (centre - data.geom_xpos[ground])) - height
                mujoco.mj_jac(m, data, full, None, centre - away * up, int(m.geom_bodyid[foot]))
                jacobian[k, f] = full
        drives = jacobian @ plant.lift @ np.linalg.inv(plant.model.transmission)
        return Feet(*(interpolate(rows, x, len(position)) for x in (depth, normal, drives)))

    def torque(self, force: np.ndarray) -> np.ndarray:
        """Return the torque (N, n) of the drives that is equivalent to forces of the ground on the feet (N,
        3 F), by virtual work.
        """
        forces = force.reshape(len(force), -1, 3)
        return np.einsum("kfij,kfi->kj", self.jacobian, forces)

    def contact(
        self, velocity: np.ndarray, force: np.ndarray, force_noise: float, velocity_noise: np.ndarray
    ) -> Contact:
        """Return the contact data for drive velocities (N, n) and the measured force (N, 3 F).

        `velocity_noise` (n,) is that of the velocity.
        """
        forces = force.reshape(len(force), -1, 3)
        moved = np.einsum("kfij,kj->kfi", self.jacobian, velocity)
        sinking = -np.einsum("kfi,kfi->kf", self.normal, moved)
        pressed = np.einsum("kfi,kfi->kf", self.normal, forces)
        along = moved + sinking[..., None] * self.normal
        dragged = forces - pressed[..., None] * self.normal
        spread = np.sqrt(np.einsum("kfij,j->kf", self.jacobian**2, velocity_noise**2).mean())
        return Contact(
            depth=self.depth,
            sinking=sinking,
            slip=np.linalg.norm(along, axis=-1),
            pressed=pressed,
            dragged=np.linalg.norm(dragged, axis=-1),
            force_noise=force_noise,
            slip_noise=float(spread),
        )
