"""Elements of a normalised tree that differ from the user's tree, with their sizes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.models import friction_leads

_NOTHING = 1e-9  # relative difference that is no addition: the mass of a body that has weight only


@dataclass(frozen=True)
class Addition:
    """One number of the file that differs from the user's; `before` is None where the element is new."""

    element: str
    quantity: str
    before: float | None
    after: float
    unit: str

    def __str__(self) -> str:
        was = "" if self.before is None else f" (was {self.before:.6g})"
        return f"{self.element}: {self.quantity} = {self.after:.6g} {self.unit}".rstrip() + was


def additions(before: mujoco.MjModel, after: mujoco.MjModel) -> tuple[Addition, ...]:
    """Compare two compiled trees: bodies, joints, tendons and actuators, by name."""
    # the user's actuators are no motors of this tree, whatever their names
    old, found = {key: entry for key, entry in _numbers(before) if not key[0].startswith("motor ")}, []
    elements = {element for element, _ in old}
    for (element, quantity), (value, unit) in _numbers(after):
        was = old.get((element, quantity), (0.0, ""))[0] if element in elements else None
        if abs(value - (was or 0.0)) > _NOTHING * max(abs(value), abs(was or 0.0)):
            found.append(Addition(element, quantity, was, value, unit))
    return tuple(found)


def _numbers(m: mujoco.MjModel) -> Iterator[tuple[tuple[str, str], tuple[float, str]]]:
    """Yield ``(element, quantity) -> (value, unit)`` for every number that normalisation may change."""
    for b in range(1, m.nbody):
        element = f"body {m.body(b).name or b}"
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, m.body_iquat[b])
        about = turn.reshape(3, 3) @ np.diag(m.body_inertia[b]) @ turn.reshape(3, 3).T
        yield (element, "mass"), (float(m.body_mass[b]), "kg")
        for k, axis in enumerate("xyz"):
            yield (element, f"centre of mass {axis}"), (float(m.body_ipos[b, k]), "m")
        for k, axis in enumerate("xyz"):
            yield (element, f"inertia {axis}{axis}"), (float(about[k, k]), "kg*m^2")
        yield (element, "gravcomp"), (float(m.body_gravcomp[b]), "")
    for j in range(m.njnt):
        dof, slide = m.jnt_dofadr[j], m.jnt_type[j] == mujoco.mjtJoint.mjJNT_SLIDE
        own = m.dof_armature[dof], m.dof_damping[dof], m.dof_frictionloss[dof], m.jnt_stiffness[j]
        yield from _axis(f"joint {m.joint(j).name}", own, slide)
        rest = float(m.qpos_spring[m.jnt_qposadr[j]])
        yield (f"joint {m.joint(j).name}", "spring reference"), (rest, "m" if slide else "rad")
    for t in range(m.ntendon):
        own = m.tendon_armature[t], m.tendon_damping[t], m.tendon_frictionloss[t], m.tendon_stiffness[t]
        first = m.wrap_objid[m.tendon_adr[t]]
        along = m.wrap_type[m.tendon_adr[t]] == mujoco.mjtWrap.mjWRAP_JOINT
        slide = along and m.jnt_type[first] == mujoco.mjtJoint.mjJNT_SLIDE
        yield from _axis(f"tendon {m.tendon(t).name}", own, slide)
        play = float(np.ptp(m.tendon_lengthspring[t]))
        yield (f"tendon {m.tendon(t).name}", "dead band"), (play, "m" if slide else "rad")
    for element, lead in friction_leads(m).items():
        yield (element, "friction turns early by"), (lead, "s")
    for a in range(m.nu):
        element = f"motor {m.actuator(a).name}"
        yield (element, "gear"), (float(m.actuator_gear[a, 0]), "")
        if m.actuator_gainprm[a, 0] != 1.0:
            yield (element, "gain"), (float(m.actuator_gainprm[a, 0]), "")
        yield (element, "bias"), (float(m.actuator_biasprm[a, 0]), "N*m")
        yield (element, "delay"), (float(m.actuator_delay[a]), "s")
        if m.actuator_ctrllimited[a]:
            yield (element, "torque limit"), (float(m.actuator_ctrlrange[a, 1]), "N*m")


def _axis(
    element: str, values: tuple[float, ...], slide: bool
) -> Iterator[tuple[tuple[str, str], tuple[float, str]]]:
    names = ("armature", "damping", "frictionloss", "stiffness")
    rotary, linear = ("kg*m^2", "N*m*s/rad", "N*m", "N*m/rad"), ("kg", "N*s/m", "N", "N/m")
    for name, value, unit in zip(names, values, linear if slide else rotary, strict=True):
        yield (element, name), (float(value), unit)
