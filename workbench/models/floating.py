"""A floating base as six joints in a row, so that its coordinates are ordinary axes.

No drive moves these axes; where they are and how fast, a recording's ``base_...`` columns say. Three slides
along the world come first, then yaw, pitch and roll about axes that turn with each other (z, y', x'').
"""

from __future__ import annotations

from pathlib import Path

import mujoco

from workbench.core import InputError

#: Axes of a base that floats, and joints of the tree of the same names: the last of a model.
BASE_AXES = ("base_x", "base_y", "base_z", "base_yaw", "base_pitch", "base_roll")

_SLIDE, _HINGE = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
_FREELY, _NONE = mujoco.mjtLimited.mjLIMITED_FALSE, (0.0, 0.0, 0.0)
_ALONG = {
    "base_x": (_SLIDE, (1, 0, 0)),
    "base_y": (_SLIDE, (0, 1, 0)),
    "base_z": (_SLIDE, (0, 0, 1)),
    "base_yaw": (_HINGE, (0, 0, 1)),
    "base_pitch": (_HINGE, (0, 1, 0)),
    "base_roll": (_HINGE, (1, 0, 0)),
}


def take_apart(spec: mujoco.MjSpec, file: Path) -> None:
    """Replace a tree's free joint by six joints; a tree without one is unchanged.

    Raises:
        InputError: several bodies float, or one inside of another, or a name of the six is taken.
    """
    free = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_FREE]
    if not free:
        return
    if len(free) > 1:
        names = ", ".join(f"'{joint.parent.name}'" for joint in free)
        raise InputError(f"bodies {names} all float", file=file, remedy="leave all but the robot out")
    if free[0].parent.parent.name != spec.worldbody.name:
        raise InputError(
            f"body '{free[0].parent.name}' floats inside of another", file=file,
            remedy="let only a base float",
        )  # fmt: skip
    taken = {joint.name for joint in spec.joints} & set(BASE_AXES)
    if taken:
        raise InputError(
            f"joint '{min(taken)}' has the name of an axis of the base", file=file, remedy="rename it"
        )
    for key in list(spec.keys):  # postures of seven numbers for a base
        spec.delete(key)
    body = free[0].parent
    spec.delete(free[0])
    body.alt.type, body.quat = mujoco.mjtOrientation.mjORIENTATION_QUAT, (1.0, 0.0, 0.0, 0.0)
    for axis, own in zip(BASE_AXES, (*body.pos, 0.0, 0.0, 0.0), strict=True):
        kind, along = _ALONG[axis]
        body.add_joint(
            name=axis, type=kind, axis=along, pos=(0.0, 0.0, 0.0), ref=own, armature=0.0, damping=_NONE,
            stiffness=_NONE, frictionloss=0.0, limited=_FREELY, actfrclimited=_FREELY,
        )  # fmt: skip
