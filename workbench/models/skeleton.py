"""Links of a serial tree along a motion, as line segments in space, by MuJoCo's kinematics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import Recording

from .model import Model
from .spec import load_tree

_FEWEST, _MOST = 64, 1800  # pictures; between them a page interpolates
_RATE_HZ = 60.0
_THIN = 0.04  # radius of a link that has no shape, over its length


@dataclass(frozen=True)
class Skeleton:
    """Segments of S links, each fixed to a body.

    Attributes:
        spec: the compiled tree.
        body: number of the body, (S,).
        ends: both ends in the body's frame [m], (S, 2, 3).
        radius: [m], (S,).
        tip: the segment whose second end is the farthest out: a foot or a tool.
    """

    spec: mujoco.MjModel
    body: np.ndarray
    ends: np.ndarray
    radius: np.ndarray
    tip: int

    @staticmethod
    def of(serial: Path) -> Skeleton:
        """Return capsules and cylinders of an MJCF; for a body without any, lines from joint to joint."""
        m = load_tree(serial).compile()
        rows: list[tuple[int, np.ndarray, float]] = []
        for body in range(1, m.nbody):
            own = _shapes(m, body) or _lines(m, body)
            rows += [(body, ends, radius) for ends, radius in own]
        if not rows:
            rows = [(0, np.array([[0.0, 0, 0], [0, 0, 0.1]]), 0.005)]
        depth = [_depth(m, body) for body, _, _ in rows]
        return Skeleton(
            m,
            np.array([r[0] for r in rows]),
            np.stack([r[1] for r in rows]),
            np.array([r[2] for r in rows]),
            int(np.argmax(depth)),
        )

    def along(
        self, model: Model, recording: Recording, joints_of: Callable[[np.ndarray], np.ndarray] | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the segments along the motion of a recording (or a run of it).

        Args:
            model: whose tree this is.
            recording: in joint or drive coordinates.
            joints_of: joint positions (N, n) at those of the drives, where the transmission changes with the
                posture.

        Returns:
            Times [s], (T,), at most 60 per second, and segments [m], (T, S, 2, 3).
        """
        most = min(_MOST, len(recording))
        count = int(np.clip(recording.duration * _RATE_HZ, min(_FEWEST, most), most))
        rows = np.unique(np.linspace(0, len(recording) - 1, count).round().astype(int))
        joints = recording.position[rows]
        if recording.coordinates == "actuator":
            constant = np.linalg.inv(model.transmission).T
            joints = joints @ constant if joints_of is None else joints_of(joints)
        m, data = self.spec, mujoco.MjData(self.spec)
        columns = [m.joint(name).qposadr[0] for name in model.joints]
        out = np.empty((len(rows), *self.ends.shape))
        for k, q in enumerate(joints):
            data.qpos[columns] = np.nan_to_num(q)
            mujoco.mj_kinematics(m, data)
            turn = data.xmat[self.body].reshape(-1, 3, 3)
            out[k] = np.einsum("sij,skj->ski", turn, self.ends) + data.xpos[self.body][:, None]
        return recording.time[rows], out


def facing(segments: np.ndarray) -> float:
    """The azimuth [rad] of the best view of a motion: across the vertical plane that contains most of it."""
    flat = segments[..., :2].reshape(-1, 2)
    flat = flat - flat.mean(axis=0)
    across = np.linalg.eigh(flat.T @ flat)[1][:, 0]
    # of the two sides the one from which x goes to the right
    side = across if across[1] < 0 or (across[1] == 0 and across[0] > 0) else -across
    return float(np.arctan2(side[1], side[0]))


def _shapes(m: mujoco.MjModel, body: int) -> list[tuple[np.ndarray, float]]:
    out = []
    for geom in range(m.ngeom):
        if m.geom_bodyid[geom] != body:
            continue
        kind, size = m.geom_type[geom], m.geom_size[geom]
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, m.geom_quat[geom])
        along = turn.reshape(3, 3)
        if kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER):
            half, radius = size[1] * along[:, 2], size[0]
        elif kind in (mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
            longest = int(np.argmax(size))
            others = np.delete(size, longest)
            half, radius = size[longest] * along[:, longest], float(others.mean())
        else:
            continue
        centre = m.geom_pos[geom]
        out.append((np.stack([centre - half, centre + half]), float(radius)))
    return out


def _lines(m: mujoco.MjModel, body: int) -> list[tuple[np.ndarray, float]]:
    """Lines from a body's joint to those of its child bodies; for the last body, to its site or its mass."""
    joint = m.body_jntadr[body]
    start = m.jnt_pos[joint] if joint >= 0 else np.zeros(3)
    to = [m.body_pos[child] for child in range(1, m.nbody) if m.body_parentid[child] == body]
    if not to:
        to = [m.site_pos[s] for s in range(m.nsite) if m.site_bodyid[s] == body] or [2 * m.body_ipos[body]]
    lengths = [float(np.linalg.norm(end - start)) for end in to]
    return [
        (np.stack([start, end]), max(_THIN * length, 1e-4))
        for end, length in zip(to, lengths, strict=True)
        if length > 1e-6
    ]


def _depth(m: mujoco.MjModel, body: int) -> int:
    depth = 0
    while body:
        body, depth = m.body_parentid[body], depth + 1
    return depth
