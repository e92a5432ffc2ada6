"""A URDF as a serial tree: joints and inertias; visuals are dropped, so that no mesh is needed."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import mujoco

from workbench.core import InputError
from workbench.core.files import read_file
from workbench.core.xml import parse_xml

from .bound import refuse_constraints
from .engine import refused

_LOOKS = "visual", "collision"
_KEPT = {"link", "joint"}
_COMPILER = {"fusestatic": "false", "discardvisual": "true"}


def is_urdf(file: Path) -> bool:
    """Return whether a model's file is a URDF, by its ending."""
    return file.suffix.lower() == ".urdf"


def load_urdf(file: Path) -> mujoco.MjSpec:
    """Parse links and joints of a URDF; the frame of a single last link is a payload site.

    Raises:
        InputError: no URDF, one that xacro has yet to expand, one with loops or joints that follow others, or
            one that MuJoCo cannot read.
    """
    raw = read_file(file)
    root = parse_xml(raw, file, prefixes=False)
    if root.tag != "robot":
        raise InputError(f"it is a <{root.tag}>", file=file, remedy="a URDF is a <robot>")
    if b"<xacro:" in raw or b"${" in raw:
        raise InputError("holds xacro macros", file=file, remedy="expand it: xacro robot.xacro > robot.urdf")
    refuse_constraints(root, file)
    for child in list(root):
        if child.tag not in _KEPT:
            root.remove(child)
    for link in root.iter("link"):
        for looks in [part for part in link if part.tag in _LOOKS]:
            link.remove(looks)
    settings = ElementTree.SubElement(root, "mujoco")
    ElementTree.SubElement(settings, "compiler", _COMPILER)
    with refused("read this URDF", file):
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    ends = [body for body in spec.bodies if body.parent is not None and not body.bodies]
    if len(ends) == 1:
        ends[0].add_site(name=ends[0].name)
    return spec
