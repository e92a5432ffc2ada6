"""A normalised MJCF as URDF: links, joints, damping and dry friction, and the names of what is lost."""

from __future__ import annotations

from xml.etree import ElementTree

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError
from workbench.core.turns import roll_pitch_yaw
from workbench.models import Inertial

_TYPES = {int(mujoco.mjtJoint.mjJNT_HINGE): "revolute", int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic"}

_OF_JOINTS = "rotor inertia (armature)", "stiffness"
#: Of inertia, weight or mass: what is less is rounding, and nobody loses it.
ROUNDING = 1e-9


def urdf_text(xml: str) -> tuple[str, tuple[str, ...]]:
    """Return the tree of a plain MJCF as URDF.

    Returns:
        ``(text, lost)``: what URDF has no place for, each with its number.

    Raises:
        InputError: a body with several joints or one that floats, which no URDF link has.
    """
    m = mujoco.MjModel.from_xml_string(xml)
    robot = ElementTree.Element("robot", name=ElementTree.fromstring(xml).get("model") or "robot")
    ElementTree.SubElement(robot, "link", name="world")
    lost: list[str] = []
    names = ["world", *(m.body(b).name or f"body_{b}" for b in range(1, m.nbody))]
    for b in range(1, m.nbody):
        _link(robot, m, b, names[b])
        _joint(robot, m, b, names, lost)
    for s in range(m.nsite):
        if m.site(s).name and m.site(s).name not in names:
            _tip(robot, m, s, names)
    for t in range(m.ntendon):
        lost += _of_tendon(m, t)
    for a in range(m.nu):
        if m.actuator_delay[a]:
            lost.append(f"motor {m.actuator(a).name}: delay {m.actuator_delay[a]:g} s")
    lifted = [b for b in range(1, m.nbody) if abs(m.body_gravcomp[b]) > ROUNDING]
    lost += [
        f"body {names[b]}: gravcomp, only {1 - m.body_gravcomp[b]:.6g} of its mass weighs" for b in lifted
    ]
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode") + "\n", tuple(lost)


def _of_tendon(m: mujoco.MjModel, t: int) -> list[str]:
    """What a tendon has, in a line; none where that is rounding beside the links' inertia and weight."""
    inertia, torque = _scales(m)
    terms = (
        ("inertia", m.tendon_armature[t], inertia),
        ("damping", _first(m.tendon_damping[t]), torque),
        ("dry friction", m.tendon_frictionloss[t], torque),
        ("stiffness", _first(m.tendon_stiffness[t]), torque),
    )
    told = [f"{name} {float(value):.6g}" for name, value, least in terms if abs(value) > ROUNDING * least]
    return [f"tendon {m.tendon(t).name}: {', '.join(told)}"] if told else []


def _scales(m: mujoco.MjModel) -> tuple[float, float]:
    """Least inertia about a joint [kg m^2], and the weight's largest torque [N m]."""
    least = float(m.dof_M0[m.dof_M0 > 0.0].min(initial=np.inf))
    return (least if np.isfinite(least) else 0.0), float(9.81 * m.body_mass.sum() * m.stat.extent)


def _first(value: np.ndarray | float) -> float:
    return float(np.ravel(value)[0])


def _link(robot: ElementTree.Element, m: mujoco.MjModel, b: int, name: str) -> None:
    link = ElementTree.SubElement(robot, "link", name=name)
    if m.body_mass[b] <= 0.0:
        return
    own = Inertial.of(m, b)
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=_numbers(own.centre))
    ElementTree.SubElement(inertial, "mass", value=repr(own.mass))
    pairs = ("xx", "yy", "zz", "xy", "xz", "yz")
    parts = {f"i{x}{y}": repr(float(own.tensor["xyz".index(x), "xyz".index(y)])) for x, y in pairs}
    ElementTree.SubElement(inertial, "inertia", parts)


def _joint(robot: ElementTree.Element, m: mujoco.MjModel, b: int, names: list[str], lost: list[str]) -> None:
    count, first = int(m.body_jntnum[b]), int(m.body_jntadr[b])
    if count > 1 or (count and int(m.jnt_type[first]) not in _TYPES):
        raise InputError(
            f"body '{names[b]}' has {count} joints, or one that is neither hinge nor slide",
            remedy="a URDF link has one joint: take another target",
        )
    if count and np.abs(m.jnt_pos[first]).max() > 1e-12:
        raise InputError(
            f"joint '{m.joint(first).name}' is not at its body's origin",
            remedy="move the origin there in the MJCF",
        )
    kind = _TYPES[int(m.jnt_type[first])] if count else "fixed"
    if count and not m.jnt_limited[first] and kind == "revolute":
        kind = "continuous"
    name = m.joint(first).name if count else f"{names[b]}_fixed"
    joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=names[int(m.body_parentid[b])])
    ElementTree.SubElement(joint, "child", link=names[b])
    _origin(joint, m.body_pos[b], m.body_quat[b])
    if not count:
        return
    dof = int(m.jnt_dofadr[first])
    ElementTree.SubElement(joint, "axis", xyz=_numbers(m.jnt_axis[first]))
    effort = _effort(m, first)
    if m.jnt_limited[first] or effort:
        low, high = m.jnt_range[first] if m.jnt_limited[first] else (-1e3, 1e3)
        ElementTree.SubElement(
            joint, "limit", lower=repr(float(low)), upper=repr(float(high)), effort=repr(effort or 1e3),
            velocity="1000.0",
        )  # fmt: skip
    damping, friction = _first(m.dof_damping[dof]), float(m.dof_frictionloss[dof])
    if damping or friction:
        ElementTree.SubElement(joint, "dynamics", damping=repr(damping), friction=repr(friction))
    rotor, stiffness = m.dof_armature[dof], _first(m.jnt_stiffness[first])
    scales = (m.dof_M0[dof], _scales(m)[1])
    for what, value, scale in zip(_OF_JOINTS, (rotor, stiffness), scales, strict=True):
        if abs(value) > ROUNDING * scale:
            lost.append(f"joint {name}: {what} {float(value):.6g}")


def _effort(m: mujoco.MjModel, joint: int) -> float:
    """Return the torque limit of the motor on this joint, 0 if there is none."""
    for a in range(m.nu):
        on_it = m.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT) and m.actuator_trnid[a, 0] == joint
        if on_it and m.actuator_ctrllimited[a]:
            return float(m.actuator_ctrlrange[a, 1] * abs(m.actuator_gear[a, 0]))
    return 0.0


def _tip(robot: ElementTree.Element, m: mujoco.MjModel, s: int, names: list[str]) -> None:
    """Add a site as a link without mass, which is how a URDF states a frame."""
    name = m.site(s).name
    ElementTree.SubElement(robot, "link", name=name)
    joint = ElementTree.SubElement(robot, "joint", name=f"{name}_fixed", type="fixed")
    ElementTree.SubElement(joint, "parent", link=names[int(m.site_bodyid[s])])
    ElementTree.SubElement(joint, "child", link=name)
    _origin(joint, m.site_pos[s], m.site_quat[s])


def _origin(joint: ElementTree.Element, at: np.ndarray, quat: np.ndarray) -> None:
    turn = roll_pitch_yaw(Rotation.from_quat(quat, scalar_first=True))
    ElementTree.SubElement(joint, "origin", xyz=_numbers(at), rpy=_numbers(turn))


def _numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(x) + 0.0) for x in values)
