"""The numbers of a URDF as those of an SDF file: a tree of links, read with the standard library alone."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError
from workbench.core.files import read_file
from workbench.core.xml import parse_xml

from .sdf import HERE, Joint, Link, Pose, SdfTree, based, read_sdf

_KINDS = ("revolute", "continuous", "prismatic", "fixed")
_WORLD = "world"


def read_tree(file: Path) -> SdfTree:
    """Return the tree of an SDF or URDF file.

    Raises:
        InputError: neither, or something in it that a tree of hinges and slides has not.
    """
    if file.suffix.lower() != ".urdf":
        return read_sdf(file)
    root = parse_xml(read_file(file), file, prefixes=False)
    if root.tag != "robot":
        raise InputError(f"it is a <{root.tag}>", file=file, remedy="a URDF is a <robot>")
    try:
        return _read(root, file)
    except (ValueError, KeyError) as error:
        raise InputError(
            f"cannot be read: {error}", file=file, remedy="see the URDF specification"
        ) from error


def _read(root: ElementTree.Element, file: Path) -> SdfTree:
    elements = [joint for joint in root.findall("joint") if joint.get("type") is not None]
    holders = {_end(joint, "child"): joint for joint in elements}
    placed: dict[str, Pose] = {}

    def place(link: str) -> Pose:
        """Return a link's pose in the root link's frame, joints at zero; its own frame is its joint's."""
        if link not in placed:
            placed[link] = HERE  # ends a chain of links that hang on each other
            if link in holders:
                joint = holders[link]
                placed[link] = place(_end(joint, "parent")).then(_pose(joint.find("origin")))
        return placed[link]

    links = [
        _link(each, place(each.attrib["name"])) for each in root.findall("link") if each.get("name") != _WORLD
    ]
    joints = [_joint(each, file) for each in elements]
    return SdfTree(file, tuple(links), (*joints, *based(links, joints)), ())


def _link(element: ElementTree.Element, at: Pose) -> Link:
    name, inertial = element.attrib["name"], element.find("inertial")
    mass = inertial.find("mass") if inertial is not None else None
    about = inertial.find("inertia") if inertial is not None else None
    if inertial is None or mass is None or about is None or float(mass.attrib["value"]) == 0.0:
        return Link(name, at, 0.0, np.zeros(3), np.zeros((3, 3)))
    own = _pose(inertial.find("origin"))
    xx, yy, zz, xy, xz, yz = (float(about.get(k, "0")) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Link(name, at, float(mass.attrib["value"]), own.at, own.turn @ matrix @ own.turn.T)


def _joint(element: ElementTree.Element, file: Path) -> Joint:
    name, kind = element.attrib["name"], element.get("type") or ""
    if kind not in _KINDS:
        raise InputError(
            f"joint '{name}' is of type '{kind}'", file=file, remedy=f"joints may be {', '.join(_KINDS)}"
        )
    parent, axis = _end(element, "parent"), element.find("axis")
    along = _numbers(axis.get("xyz", "1 0 0") if axis is not None else "1 0 0")
    coordinates = () if kind == "fixed" else ((name, along / np.linalg.norm(along)),)
    return Joint(name, kind, None if parent == _WORLD else parent, _end(element, "child"), HERE, coordinates)


def _end(joint: ElementTree.Element, side: str) -> str:
    found = joint.find(side)
    if found is None:
        raise ValueError(f"joint '{joint.get('name')}' has no {side}")
    return found.attrib["link"]


def _pose(origin: ElementTree.Element | None) -> Pose:
    if origin is None:
        return HERE
    turn = Rotation.from_euler("xyz", _numbers(origin.get("rpy", "0 0 0"))).as_matrix()
    return Pose(turn, _numbers(origin.get("xyz", "0 0 0")))


def _numbers(text: str) -> np.ndarray:
    values = np.array([float(x) for x in text.split()])
    if len(values) != 3:
        raise ValueError(f"'{text}' is not three numbers")
    return values
