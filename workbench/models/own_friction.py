"""Dry friction that an MJCF or URDF states at its joints: an effect of the model like any other."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from workbench.core import EffectKey, Estimate

from .model import AppliedEffect, Model
from .serial import NO_FRICTION, drives_alone, joint_kinds
from .spec import load_tree


def own_friction(model: Model) -> tuple[AppliedEffect, ...]:
    """``frictionloss`` of the model's joints as `coulomb_friction`, one effect a joint that states some.

    At a joint that one drive turns, and no other, it is that drive's, as the joint's armature and damping
    are; at any other it is the joint's own.
    """
    loss = _at_joints(model.serial, tuple(model.joints))
    alone, turned, ratio = drives_alone(model)
    drive = {int(turned[k]): int(k) for k in np.flatnonzero(alone)}
    out = []
    for joint in map(int, np.flatnonzero(loss)):
        torque = Estimate(float(loss[joint]), 0.0, "N" if joint_kinds(model)[joint] == "slide" else "N*m")
        key = EffectKey("coulomb_friction", model.axes[joint], "joint")
        if joint in drive:
            key = EffectKey("coulomb_friction", model.axes[drive[joint]])
            torque = replace(torque, value=torque.value / abs(float(ratio[drive[joint]])))
        out.append(AppliedEffect(key, {"torque": torque}))
    return tuple(out)


@lru_cache(maxsize=64)
def _at_joints(serial: Path, joints: tuple[str, ...]) -> np.ndarray:
    """``frictionloss`` (n,) of an MJCF's joints; none where its flag switches dry friction off."""
    m = load_tree(serial).compile()
    if m.opt.disableflags & NO_FRICTION:
        return np.zeros(len(joints))
    return m.dof_frictionloss[[m.joint(name).dofadr[0] for name in joints]].copy()
