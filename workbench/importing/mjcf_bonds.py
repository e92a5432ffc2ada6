"""What a compiled MJCF says of its joints beside the tree: bonds, balls, and the limits of motors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np
from numpy.polynomial import Polynomial

from workbench.core import Coupling, InputError

_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
_ONE_COORDINATE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)


def ends(m: mujoco.MjModel, e: int) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """Of a connect or weld: body, point (3,) [m] and turn (4,) in it, of either side."""
    first, second = int(m.eq_obj1id[e]), int(m.eq_obj2id[e])
    if m.eq_objtype[e] == mujoco.mjtObj.mjOBJ_SITE:
        return [(int(m.site_bodyid[s]), m.site_pos[s], m.site_quat[s]) for s in (first, second)]
    # compiled: the point on either body, of a weld the second's first, and how that one is turned
    weld = m.eq_type[e] == mujoco.mjtEq.mjEQ_WELD
    one, other = (m.eq_data[e, 3:6], m.eq_data[e, 0:3])[:: 1 if weld else -1]
    return [(first, one, m.eq_data[e, 6:10] if weld else _UPRIGHT), (second, other, _UPRIGHT)]


def coupling(m: mujoco.MjModel, e: int, file: Path) -> Coupling:
    """Return a joint that follows another, between positions, not ways from the file's pose as in MuJoCo.

    Raises:
        InputError: one of them is a ball.
    """
    first, second = int(m.eq_obj1id[e]), int(m.eq_obj2id[e])
    if any(int(m.jnt_type[j]) not in _ONE_COORDINATE for j in (first, second) if j >= 0):
        raise InputError(
            f"the equality '{m.eq(e).name}' (joint) binds a ball", file=file, column="equality.joint",
            remedy="bind hinges and slides",
        )  # fmt: skip
    own = m.qpos0[m.jnt_qposadr[first]]
    if second < 0:
        return Coupling(m.joint(first).name, None, (float(m.eq_data[e, 0] + own),))
    from_zero = Polynomial([-m.qpos0[m.jnt_qposadr[second]], 1.0])
    factors = np.atleast_1d((Polynomial(m.eq_data[e, :5])(from_zero) + own).coef)
    kept = tuple(map(float, np.trim_zeros(factors, "b")))
    return Coupling(m.joint(first).name, m.joint(second).name, kept or (0.0,))


def across_rod(m: mujoco.MjModel, j: int, file: Path) -> np.ndarray:
    """Two axes (2, 3) of a ball joint, in its body, across the rod that it holds at one end.

    A rod between two balls turns about itself as it likes, which moves nothing else: that turn is left out.

    Raises:
        InputError: its body is no rod whose other end a connect holds.
    """
    body = int(m.jnt_bodyid[j])
    held = [
        at
        for e in range(m.neq)
        if m.eq_active0[e] and m.eq_type[e] == mujoco.mjtEq.mjEQ_CONNECT
        for carrier, at, _ in ends(m, e)
        if carrier == body
    ]
    rod = held[0] - m.jnt_pos[j] if len(held) == 1 else np.zeros(3)
    if np.linalg.norm(rod) < 1e-6 or body in m.body_parentid[1:]:
        raise InputError(
            f"joint '{m.joint(j).name}' is a ball", file=file,
            remedy="a ball joint is allowed only for a rod whose other end one <connect> holds; otherwise "
                "use hinges and slides",
        )  # fmt: skip
    return np.linalg.svd(rod[None])[2][1:]


def free_joints(m: mujoco.MjModel) -> set[int]:
    """Joints by which a base hangs free: a free joint, or three slides and a ball of one body."""
    free, ball, slide = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL, mujoco.mjtJoint.mjJNT_SLIDE
    out: set[int] = set()
    for body in np.flatnonzero(m.body_parentid[1:] == 0) + 1:
        joints = range(m.body_jntadr[body], m.body_jntadr[body] + m.body_jntnum[body])
        kinds = sorted(int(m.jnt_type[j]) for j in joints)
        if kinds in ([int(free)], sorted([int(ball), *[int(slide)] * 3])):
            out |= set(joints)
    return out


def resting(m: mujoco.MjModel, joints: Sequence[int]) -> dict[str, float]:
    """Joint -> where it is when a robot stands as its file says [rad or m].

    That is the first keyframe. Without one, of joints that are not at zero, the file's own pose, or the
    middle of the range where that pose is outside of it.
    """
    if m.nkey:
        return {m.joint(j).name: round(float(m.key_qpos[0, m.jnt_qposadr[j]]), 6) for j in joints}
    out = dict[str, float]()
    for j in joints:
        at, (low, high) = float(m.qpos0[m.jnt_qposadr[j]]), m.jnt_range[j]
        if m.jnt_limited[j] and not low <= at <= high:
            at = float(low + high) / 2.0
        if at:
            out[m.joint(j).name] = round(at, 6)
    return out


def motors_of(m: mujoco.MjModel, j: int) -> np.ndarray:
    """Return the actuators that turn a joint itself."""
    return np.flatnonzero(
        (m.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)) & (m.actuator_trnid[:, 0] == j)
    )


def torque_limit(m: mujoco.MjModel, j: int) -> float:
    """Torque limit of a joint's one motor or of the joint, the lower one; inf where none is stated.

    A limit that is another on either side is none here.
    """
    ranges = [m.jnt_actfrcrange[j]] if m.jnt_actfrclimited[j] else []
    own = motors_of(m, j)
    if len(own) == 1:
        a = own[0]
        motor = m.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_NONE
        gear = abs(float(m.actuator_gear[a, 0]))
        if m.actuator_forcelimited[a]:
            ranges.append(gear * m.actuator_forcerange[a])
        elif motor and m.actuator_ctrllimited[a]:
            ranges.append(gear * abs(float(m.actuator_gainprm[a, 0])) * m.actuator_ctrlrange[a])
    return min((float(high) for low, high in ranges if high == -low), default=float("inf"))
