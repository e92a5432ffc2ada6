"""The serial tree of a mechanism as MJCF: links on the way to its ends, and nothing of the linkage."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError, Mechanism
from workbench.mechanism.parse import GRAVITY, finished, parse
from workbench.s3n.loop import solid

_KINDS = {"revolute": "hinge", "prismatic": "slide", "weld": "fixed"}
_THIN = 0.008  # m, radius of the bars that are drawn


def serial_mjcf(mechanism: Mechanism, name: str) -> str:
    """MJCF of the links from the world to foot and serial joints, with the file's frames and inertias.

    Args:
        mechanism: its file, serial joints and foot.
        name: of the MJCF's model.

    Raises:
        InputError: no way from the world to the foot passes the serial joints and no other.
    """
    plant, model = parse(mechanism.file)
    finished(plant, mechanism.file)
    root = ElementTree.Element("mujoco", model=name)
    ElementTree.SubElement(root, "compiler", angle="radian", inertiafromgeom="false")
    ElementTree.SubElement(root, "option", gravity=f"0 0 {-GRAVITY}", timestep="0.001")
    holder = ElementTree.SubElement(root, "worldbody")
    context: Any = plant.CreateDefaultContext()
    plant.SetPositions(context, np.zeros(plant.num_positions()))
    held = _held(mechanism)
    for joint_name, position in held.items():
        joint = plant.GetJointByName(joint_name, model)
        plant.SetPositions(context, _placed(plant, context, joint, position))
    bodies = {plant.world_body().index(): holder}
    for joint in _ways(plant, model, mechanism):
        holder = bodies[joint.parent_body().index()]
        bodies[joint.child_body().index()] = _add_body(holder, plant, context, joint, mechanism)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _ways(plant: Any, model: Any, mechanism: Mechanism) -> list[Any]:
    """Joints on the ways from the world to the foot and to every serial joint, each after those before it."""
    inboard = {}
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        inboard[joint.child_body().index()] = joint
    ends = [plant.GetJointByName(name, model).child_body() for name in mechanism.joints]
    if mechanism.foot:
        ends.append(plant.GetFrameByName(mechanism.foot, model).body())
    way: list[Any] = []
    for body in ends:
        own: list[Any] = []
        while body.index() in inboard:
            own.append(inboard[body.index()])
            body = own[-1].parent_body()
        known = {joint.index() for joint in way}
        way += [joint for joint in reversed(own) if joint.index() not in known]
    held = _held(mechanism)
    moving = [joint.name() for joint in way if joint.num_positions() and joint.name() not in held]
    if sorted(moving) != sorted(mechanism.joints):
        extra = [joint for joint in way if joint.name() in set(moving) - set(mechanism.joints)]
        beyond = [name for name in mechanism.joints if extra and _behind(plant, model, name, extra[0])]
        limb = (
            f"; or, where loops move {extra[0].name()}, end the limb before it (leave out "
            f"{', '.join(beyond)} and its drive, with --hold-rest) and import the part beyond it "
            "separately"
            if beyond
            else ""
        )
        raise InputError(
            f"the way to {mechanism.foot or 'the last joint'} passes {', '.join(moving) or 'no joint'}, "
            "and a serial tree has one joint per drive",
            file=mechanism.file, column="closed_chain.joints",
            remedy=f"name these as serial joints, hold those that stay, or name another foot{limb}",
        )  # fmt: skip
    strange = [joint for joint in way if joint.type_name() not in _KINDS]
    if strange:
        raise InputError(
            f"joint '{strange[0].name()}' is of type {strange[0].type_name()}", file=mechanism.file,
            remedy="serial joints may be revolute or prismatic",
        )  # fmt: skip
    return way


def _behind(plant: Any, model: Any, name: str, joint: Any) -> bool:
    """Whether a joint hangs on what another one moves."""
    inboard = {plant.get_joint(i).child_body().index(): plant.get_joint(i) for i in plant.GetJointIndices()}
    body = plant.GetJointByName(name, model).parent_body()
    while body.index() in inboard:
        if inboard[body.index()].index() == joint.index():
            return True
        body = inboard[body.index()].parent_body()
    return False


def _add_body(
    holder: ElementTree.Element, plant: Any, context: Any, joint: Any, mechanism: Mechanism
) -> ElementTree.Element:
    body, parent = joint.child_body(), joint.parent_body()
    at = parent.body_frame().CalcPoseInWorld(context).inverse() @ body.body_frame().CalcPoseInWorld(context)
    out = ElementTree.SubElement(
        holder, "body", name=body.name(), pos=_numbers(at.translation()), quat=_quat(at.rotation().matrix())
    )
    kind = "fixed" if joint.name() in _held(mechanism) else _KINDS[joint.type_name()]
    if kind != "fixed":
        own = joint.frame_on_child().GetFixedPoseInBodyFrame()
        axis = joint.revolute_axis() if kind == "hinge" else joint.translation_axis()
        limits = dict(zip(mechanism.joints, mechanism.limits, strict=False))
        attributes = {
            "name": joint.name(),
            "type": kind,
            "pos": _numbers(own.translation()),
            "axis": _numbers(own.rotation().matrix() @ axis),
            "limited": "false",  # real legs go past what a file states; a run must be able to follow
        }
        if joint.name() in limits:
            attributes["range"] = _numbers(np.array(limits[joint.name()]))
        ElementTree.SubElement(out, "joint", attributes)
    _add_inertia(out, body)
    _draw(out, plant, body, mechanism)
    return out


def _held(mechanism: Mechanism) -> dict[str, float]:
    """Joints that stay where they are, and where [rad or m]."""
    return {c.joint: c.at(0.0)[0] for c in mechanism.all_couplings() if c.follows is None}


def _placed(plant: Any, context: Any, joint: Any, position: float) -> np.ndarray:
    """The plant's positions with one joint elsewhere."""
    positions = np.array(plant.GetPositions(context))
    positions[joint.position_start()] = position
    return positions


def _add_inertia(out: ElementTree.Element, body: Any) -> None:
    spatial = body.default_spatial_inertia()
    if spatial.get_mass() == 0.0:
        return
    centre = spatial.get_com()
    about = solid(spatial.Shift(centre).CalcRotationalInertia().CopyToFullMatrix3())
    full = (about[0, 0], about[1, 1], about[2, 2], about[0, 1], about[0, 2], about[1, 2])
    ElementTree.SubElement(
        out, "inertial", pos=_numbers(centre), mass=repr(float(spatial.get_mass())),
        fullinertia=_numbers(np.array(full)),
    )  # fmt: skip


def _draw(out: ElementTree.Element, plant: Any, body: Any, mechanism: Mechanism) -> None:
    """A bar to every joint that hangs on the body, and to the foot; massless, touching nothing."""
    ends = []
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        if joint.parent_body().index() == body.index() and joint.name() in mechanism.joints:
            ends.append(joint.frame_on_parent().GetFixedPoseInBodyFrame().translation())
    foot = plant.GetFrameByName(mechanism.foot) if mechanism.foot else None
    if foot is not None and foot.body().index() == body.index():
        place = foot.GetFixedPoseInBodyFrame()
        ends.append(place.translation())
        ElementTree.SubElement(
            out, "site", name=str(mechanism.foot), pos=_numbers(place.translation()), size="0.02"
        )
    for end in ends:
        if np.linalg.norm(end) > _THIN:
            ElementTree.SubElement(
                out, "geom", type="capsule", fromto=_numbers(np.concatenate([np.zeros(3), end])),
                size=str(_THIN), mass="0", contype="0", conaffinity="0",
            )  # fmt: skip


def _numbers(values: np.ndarray) -> str:
    # adding zero turns a negative zero into a plain one
    return " ".join(repr(float(v) + 0.0) for v in values)


def _quat(turn: np.ndarray) -> str:
    return _numbers(Rotation.from_matrix(turn).as_quat(scalar_first=True))
