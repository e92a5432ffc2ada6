"""Points fixed to bodies of a serial tree, at many postures at once; linear in their coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.models import Model

_PARALLEL = 1e-9  # sine of the angle between axes that count as parallel


@dataclass(frozen=True)
class Frames:
    """Poses of the B bodies that carry the joints at N postures; the world is body 0.

    A point has m free coordinates p in its body: three, or two in the plane of a plane mechanism.

    Attributes:
        bodies: their names.
        at: origins (B, N, 3) [m].
        shift: d point / d p (B, N, 3, m).
        jacobian: d origin / d q (B, N, 3, n).
        jacobian_shift: d (d point / d q) / d p (B, N, 3, n, m).
        basis: the free directions in the body's own frame (B, 3, m).
        rotation: d turning / d q in the body's own frame (B, N, 3, n).
    """

    bodies: tuple[str, ...]
    at: np.ndarray
    shift: np.ndarray
    jacobian: np.ndarray
    jacobian_shift: np.ndarray
    basis: np.ndarray
    rotation: np.ndarray

    @property
    def ways(self) -> int:
        """Number m of free coordinates of a point."""
        return self.basis.shape[2]

    @property
    def plane(self) -> bool:
        """Return whether all joints turn about parallel axes."""
        return self.ways == 2

    def place(self, bodies: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return positions of points (P, N, 3), and d point / d q (P, N, 3, n).

        Args:
            bodies: body of each (P,).
            points: free coordinates (P, m) [m].
        """
        at = self.at[bodies] + np.einsum("pnim,pm->pni", self.shift[bodies], points)
        return at, self.jacobian[bodies] + np.einsum("pnijm,pm->pnij", self.jacobian_shift[bodies], points)


def frames(m: mujoco.MjModel, model: Model, q: np.ndarray) -> Frames:
    """Return a compiled serial tree's frames at postures `q` (N, n); other joints stay at their start.

    Raises:
        InputError: a body carries two of the joints.
    """
    data = mujoco.MjData(m)
    places = [m.joint(name).qposadr[0] for name in model.joints]
    dofs = [m.joint(name).dofadr[0] for name in model.joints]
    numbers = [0, *(int(m.joint(name).bodyid[0]) for name in model.joints)]
    if len(set(numbers)) < len(numbers):
        raise InputError(
            "a body carries several joints", file=model.serial, remedy="give each joint a body of its own"
        )
    at = np.empty((len(numbers), len(q), 3))
    turn = np.empty((len(numbers), len(q), 3, 3))
    forward, turning = (np.empty((len(numbers), len(q), 3, len(dofs))) for _ in range(2))
    linear, angular = np.empty((3, m.nv)), np.empty((3, m.nv))
    for i, row in enumerate(q):
        data.qpos[places] = row
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        for k, body in enumerate(numbers):
            mujoco.mj_jac(m, data, linear, angular, data.xpos[body], body)
            at[k, i], turn[k, i] = data.xpos[body], data.xmat[body].reshape(3, 3)
            forward[k, i], turning[k, i] = linear[:, dofs], angular[:, dofs]
    basis = _basis(m, data, model, turn[:, -1])
    shift = turn @ basis[:, None]
    crossed = np.cross(turning[..., None], shift[..., None, :], axis=2)
    own = turn.transpose(0, 1, 3, 2) @ turning
    names = tuple(m.body(b).name for b in numbers)
    return Frames(names, at, shift, forward, crossed, basis, own)


def _basis(m: mujoco.MjModel, data: mujoco.MjData, model: Model, turn: np.ndarray) -> np.ndarray:
    """Return a point's free directions (B, 3, m), in frames of bodies with rotations `turn` (B, 3, 3).

    They depend on the bodies alone: points keep their coordinates from one set of postures to another.
    """
    axes = np.array([data.joint(name).xaxis for name in model.joints])
    hinges = all(m.joint(name).type[0] == mujoco.mjtJoint.mjJNT_HINGE for name in model.joints)
    if not hinges or np.abs(np.cross(axes[0], axes)).max() > _PARALLEL:
        return np.tile(np.eye(3), (len(turn), 1, 1))
    normals = np.round(turn.transpose(0, 2, 1) @ axes[0], 12)
    return np.array([_across(normal) for normal in normals])


def _across(normal: np.ndarray) -> np.ndarray:
    """Return two directions (3, 2) at right angles to a unit vector and to each other."""
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)], axis=1)
