"""A robot as moving lines, for a page or a film of a recording or a policy run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError, Recording
from workbench.models import BASE_AXES, Model, load_tree
from workbench.s3n import drive_map

FRAMES_PER_S = 30.0
_LONG = 1e-4  # m, below which a line is none
_MOST = 1800  # frames


@dataclass(frozen=True)
class Scene:
    """Lines in the world, per frame.

    Attributes:
        time: of the frames (F,) [s].
        ends: both ends of L lines (F, L, 2, 3) [m].
    """

    time: np.ndarray
    ends: np.ndarray


def scene_of(m: mujoco.MjModel, time: np.ndarray, qpos: np.ndarray) -> Scene:
    """Return the scene of a compiled tree at positions (N, nq) and times (N,) [s].

    Bodies are lines to the joints that hang on them, capsules and cylinders their axes, boxes their edges.
    """
    count = max(2, min(_MOST, round(FRAMES_PER_S * (time[-1] - time[0]))))
    rows = np.unique(np.searchsorted(time, np.linspace(time[0], time[-1], count)).clip(0, len(time) - 1))
    data, lines = mujoco.MjData(m), []
    for row in rows:
        data.qpos[:] = qpos[row]
        mujoco.mj_kinematics(m, data)
        lines.append(_lines(m, data))
    ends = np.array(lines)
    kept = np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=-1).max(axis=0) > _LONG
    return Scene(time[rows] - time[0], ends[:, kept])


def scene_of_recording(recording: Recording, model: Model) -> Scene:
    """Return the scene of a recording and the model of its machine.

    Raises:
        InputError: other axes than the model's, or a base that moves and no pose of it.
    """
    position, axes = recording.position, tuple(recording.axes)
    if model.floats and axes != tuple(model.axes):
        position, axes = np.hstack([position, _base(recording)]), (*axes, *BASE_AXES)
    if axes != tuple(model.axes):
        raise InputError(
            f"its axes are {', '.join(recording.axes)}, the model has {', '.join(model.axes)}",
            file=recording.source, column="axes", remedy="give the model of the machine that was recorded",
        )  # fmt: skip
    m = load_tree(model.serial).compile()
    if recording.coordinates == "actuator":
        own = drive_map(model)
        position = position @ np.linalg.inv(model.transmission).T if own is None else own.joints(position)
    qpos = np.tile(m.qpos0, (len(position), 1))
    qpos[:, [m.joint(name).qposadr[0] for name in model.joints]] = position
    return scene_of(m, recording.time, qpos)


def _base(recording: Recording) -> np.ndarray:
    """Where a base was, as the model's axes have it: position, then yaw, pitch and roll, (N, 6)."""
    try:
        place, turn = recording.extra["base_position"], recording.extra["base_orientation"]
    except KeyError as error:
        raise InputError(
            "no column says where its base was", file=recording.source, column=f"columns.{error.args[0]}",
            remedy="name the columns of base_position and base_orientation",
        ) from error  # fmt: skip
    return np.hstack([place, Rotation.from_quat(turn, scalar_first=True).as_euler("ZYX")])


def _lines(m: mujoco.MjModel, data: mujoco.MjData) -> list[tuple[np.ndarray, np.ndarray]]:
    out = []
    for b in range(1, m.nbody):
        parent = int(m.body_parentid[b])
        if parent:
            out.append((data.xpos[parent].copy(), data.xpos[b].copy()))
    # places that a tendon passes are no part of the robot's shape: a fitted tree has dozens
    passed = set(m.wrap_objid[m.wrap_type == mujoco.mjtWrap.mjWRAP_SITE].tolist())
    for s in set(range(m.nsite)) - passed:
        out.append((data.xpos[m.site_bodyid[s]].copy(), data.site_xpos[s].copy()))
    for g in range(m.ngeom):
        kind, at, turn = m.geom_type[g], data.geom_xpos[g], data.geom_xmat[g].reshape(3, 3)
        if kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER):
            half = turn[:, 2] * m.geom_size[g, 1]
            out.append((at - half, at + half))
        elif kind == mujoco.mjtGeom.mjGEOM_BOX:
            out += [(at + turn @ a, at + turn @ b) for a, b in _edges(m.geom_size[g])]
    return out


def _edges(half: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.asarray(half)
    pairs = [(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit]
    return [(corners[i], corners[j]) for i, j in pairs]
