"""Dry friction that an MJCF or URDF states at its joints: an effect of the model like any other."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Literal, NamedTuple

import mujoco
import numpy as np

from workbench.core import EffectKey, Estimate

from .model import AppliedEffect, Model
from .serial import NO_FRICTION, axis_tendon, drives_alone, joint_kinds
from .spec import load_tree


def own_friction(model: Model) -> tuple[AppliedEffect, ...]:
    """``frictionloss`` of the model's joints as `coulomb_friction`, one effect a joint that states some.

    At a joint that one drive turns, and no other, it is that drive's, as the joint's armature and damping
    are; at any other it is the joint's own.
    """
    loss, out = _at_joints(model.serial, tuple(model.joints)).loss, []
    for joint, axis, location, ratio in _seats(model, loss):
        unit = "N" if joint_kinds(model)[joint] == "slide" else "N*m"
        torque = Estimate(float(loss[joint]) / ratio, 0.0, unit)
        key = EffectKey("coulomb_friction", model.axes[axis], location)
        out.append(AppliedEffect(key, {"torque": torque}))
    return tuple(out)


def own_constraints(model: Model) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """``solreffriction`` (2,) and ``solimpfriction`` (5,) of the same joints, by the tendon they act on."""
    own = _at_joints(model.serial, tuple(model.joints))
    return {
        axis_tendon(axis, location): (own.reference[joint], own.impedance[joint])
        for joint, axis, location, _ in _seats(model, own.loss)
    }


def friction_leads(m: mujoco.MjModel) -> dict[str, float]:
    """Joints and tendons of a compiled MJCF with dry friction, and how soft MuJoCo's constraint for it is.

    That is the time [s] by which the friction turns before a reversal: the constraint pulls the speed w to
    ``a = -b w``, so that under an acceleration a it changes sign 1 / b early.
    """
    out: dict[str, float] = {}
    if m.opt.disableflags & NO_FRICTION:
        return out
    for k in np.flatnonzero(m.dof_frictionloss):
        name = f"joint {m.joint(m.dof_jntid[k]).name}"
        out[name] = _lead(m.dof_solref[k], m.dof_solimp[k], m.opt.timestep)
    for k in np.flatnonzero(m.tendon_frictionloss):
        name = f"tendon {m.tendon(k).name}"
        out[name] = _lead(m.tendon_solref_fri[k], m.tendon_solimp_fri[k], m.opt.timestep)
    return out


def _lead(reference: np.ndarray, impedance: np.ndarray, timestep: float) -> float:
    """One over the constraint's damping [s], as MuJoCo makes it of ``solreffriction`` (its "Computation")."""
    if reference[0] > 0.0:
        return 0.5 * float(impedance[1]) * max(float(reference[0]), 2.0 * timestep)
    return float(impedance[1] / max(-reference[1], 1e-12))


def _seats(model: Model, loss: np.ndarray) -> Iterator[tuple[int, int, Literal["actuator", "joint"], float]]:
    """Joints with dry friction, where it sits (axis and location), and the axis's speed over the joint's."""
    alone, turned, ratio = drives_alone(model)
    drive = {int(turned[k]): int(k) for k in np.flatnonzero(alone)}
    for joint in map(int, np.flatnonzero(loss)):
        if joint in drive:
            yield joint, drive[joint], "actuator", abs(float(ratio[drive[joint]]))
        else:
            yield joint, joint, "joint", 1.0


class _Stated(NamedTuple):
    """Dry friction (n,) of an MJCF's joints, and its constraint's parameters, (n, 2) and (n, 5)."""

    loss: np.ndarray
    reference: np.ndarray
    impedance: np.ndarray


@lru_cache(maxsize=64)
def _at_joints(serial: Path, joints: tuple[str, ...]) -> _Stated:
    """What an MJCF's joints state; no friction where the file's flag switches it off."""
    m = load_tree(serial).compile()
    dofs = [m.joint(name).dofadr[0] for name in joints]
    off = bool(m.opt.disableflags & NO_FRICTION)
    return _Stated(m.dof_frictionloss[dofs] * (not off), m.dof_solref[dofs], m.dof_solimp[dofs])
