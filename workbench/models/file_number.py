"""Numbers of an MJCF or URDF into which a found effect can be written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], centre (3,) [m] and inertia about it (3, 3) [kg m^2] of a body, in its own frame."""

    mass: float
    centre: np.ndarray
    tensor: np.ndarray

    @staticmethod
    def of(m: mujoco.MjModel, body: int) -> Inertial:
        """Return mass, centre and inertia of a compiled body."""
        axes = inertial_frame(m, body)
        tensor = axes @ np.diag(m.body_inertia[body]) @ axes.T
        return Inertial(float(m.body_mass[body]), m.body_ipos[body].copy(), tensor)


def inertial_frame(m: mujoco.MjModel, body: int) -> np.ndarray:
    """Return the axes (3, 3) of a compiled body's inertia, in its own frame."""
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, m.body_iquat[body])
    return flat.reshape(3, 3)


@dataclass(frozen=True)
class JointNumber:
    """An increase of one number of a joint, or of a tendon that is a drive.

    `number`: as MJCF calls it: ``damping``, ``frictionloss``, ``armature`` or ``stiffness``. `more`: of it,
    in the joint's own coordinate, SI. `rest`: where a spring of that stiffness rests [rad or m].
    """

    joint: str
    number: str
    more: float
    rest: float = 0.0
    element: Literal["joint", "tendon"] = "joint"


@dataclass(frozen=True)
class BodyNumbers:
    """New mass, centre and inertia of the body that a joint carries; values are the built model's."""

    joint: str
