"""Dry friction that an MJCF or URDF states at joints and drives, treated as an effect of the model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import mujoco
import numpy as np

from workbench.core import EffectKey, Estimate

from .model import AppliedEffect, Model
from .serial import axis_tendon, drive_tendons, drives_alone
from .spec import load_tree

#: MuJoCo's flag that switches dry friction off.
NO_FRICTION = int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)


def own_friction(model: Model) -> tuple[AppliedEffect, ...]:
    """Return ``frictionloss`` of the model's file as `coulomb_friction`, one for each joint with some.

    At a joint that one drive turns, and no other, it is that drive's, as the joint's armature and damping
    are; at any other it is the joint's own. At a tendon that is a drive it is the drive's.
    """
    return take_friction(load_tree(model.serial), model)


def take_friction(spec: mujoco.MjSpec, model: Model) -> tuple[AppliedEffect, ...]:
    """Remove and return the friction of a model's tree; its joints have none afterwards.

    What the file's flag switches off is nowhere any more, and the flag is gone: friction of effects acts.
    """
    if spec.option.disableflags & NO_FRICTION:
        spec.option.disableflags &= ~NO_FRICTION
        for element in (*spec.joints, *spec.tendons):
            element.frictionloss = 0.0
    out = []
    slides = {j.name for j in spec.joints if j.type == mujoco.mjtJoint.mjJNT_SLIDE}
    for element, axis, location, ratio in _seats(spec, model):
        turned = model.transmission[axis] if location == "actuator" else np.eye(model.size)[axis]
        unit = "N" if slides >= {model.joints[j] for j in np.flatnonzero(turned)} else "N*m"
        torque = Estimate(float(element.frictionloss) / ratio, 0.0, unit)
        key = EffectKey("coulomb_friction", model.axes[axis], location)
        out.append(AppliedEffect(key, {"torque": torque}))
        element.frictionloss = 0.0
    return tuple(out)


def own_constraints(model: Model) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """``solreffriction`` (2,) and ``solimpfriction`` (5,) of friction there, by the tendon it acts on.

    Also of joints that have none in the file: so soft would be what is added to them.
    """
    return {
        axis_tendon(axis, location): (np.array(element.solref_friction), np.array(element.solimp_friction))
        for element, axis, location, _ in _seats(load_tree(model.serial), model, none=True)
    }


def _seats(
    spec: mujoco.MjSpec, model: Model, *, none: bool = False
) -> Iterator[tuple[mujoco.MjsJoint | mujoco.MjsTendon, int, Literal["actuator", "joint"], float]]:
    """Each part with dry friction, also with `none`: place (axis, location), and the axis's speed over its
    own.
    """
    alone, turned, ratio = drives_alone(model)
    drive = {int(turned[k]): int(k) for k in np.flatnonzero(alone)}
    there = {joint.name: joint for joint in spec.joints if none or joint.frictionloss}
    for k, name in enumerate(model.joints):
        if name in there and k in drive:
            yield there[name], drive[k], "actuator", abs(float(ratio[drive[k]]))
        elif name in there:
            yield there[name], k, "joint", 1.0
    for seat in drive_tendons(model):
        tendon = spec.tendons[seat.tendon]
        if none or tendon.frictionloss:
            yield tendon, seat.index, "actuator", 1.0 / abs(seat.ratio)


def friction_leads(m: mujoco.MjModel) -> dict[str, float]:
    """Return joints and tendons of a compiled MJCF with dry friction, and how soft each constraint is.

    That is the time [s] by which the friction turns before a reversal: the constraint pulls the speed w to
    ``a = -b w``, so that under an acceleration a it changes sign 1 / b early.
    """
    out: dict[str, float] = {}
    if m.opt.disableflags & NO_FRICTION:
        return out
    for k in np.flatnonzero(m.dof_frictionloss):
        name = f"joint {m.joint(m.dof_jntid[k]).name}"
        out[name] = friction_lead(m.dof_solref[k], m.dof_solimp[k], m.opt.timestep)
    for k in np.flatnonzero(m.tendon_frictionloss):
        name = f"tendon {m.tendon(k).name}"
        out[name] = friction_lead(m.tendon_solref_fri[k], m.tendon_solimp_fri[k], m.opt.timestep)
    return out


def friction_lead(reference: np.ndarray, impedance: np.ndarray, timestep: float) -> float:
    """Return one over the constraint's damping [s], as MuJoCo derives it from ``solreffriction``
    ("Computation").
    """
    if reference[0] > 0.0:
        return 0.5 * float(impedance[1]) * max(float(reference[0]), 2.0 * timestep)
    return float(impedance[1] / max(-reference[1], 1e-12))
