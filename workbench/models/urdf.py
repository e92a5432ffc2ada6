"""A URDF as a serial tree: joints and inertias; visuals are dropped, so that no mesh is needed."""

from __future__ import annotations

import re
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
#: Settings of MuJoCo that are kept: they mend inertias, and need nothing that is dropped.
_OWN_COMPILER = "balanceinertia", "boundmass", "boundinertia"
_XACRO = re.compile(rb"<xacro:[\w.-]*")
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)


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
    for link in root.iter("link"):
        for looks in [part for part in link if part.tag in _LOOKS]:
            link.remove(looks)
    _refuse_macros([part for part in root if part.tag in _KEPT], raw, file)
    refuse_constraints(root, file)
    stated = {key: value for each in root.findall("mujoco/compiler") for key, value in each.items()}
    own = {key: stated[key] for key in _OWN_COMPILER if key in stated}
    for child in [part for part in root if part.tag not in _KEPT]:
        root.remove(child)
    settings = ElementTree.SubElement(root, "mujoco")
    ElementTree.SubElement(settings, "compiler", own | _COMPILER)
    with refused("read this URDF", file):
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    ends = [body for body in spec.bodies if body.parent is not None and not body.bodies]
    if len(ends) == 1:
        ends[0].add_site(name=ends[0].name)
    return spec


def _refuse_macros(read: list[ElementTree.Element], raw: bytes, file: Path) -> None:
    """Refuse what xacro has yet to expand; in comments, visuals and plugins an expression does no harm."""
    told = (
        f"'{value}' in {part.tag} '{part.get('name')}'"
        for part in read
        for each in part.iter()
        for value in each.attrib.values()
        if "${" in value
    )
    elements = _XACRO.search(_COMMENT.sub(b"", raw))
    if problem := elements[0].decode(errors="replace") + ">" if elements else next(told, None):
        remedy = "expand it: xacro robot.xacro > robot.urdf"
        raise InputError(f"holds xacro macros: {problem}", file=file, remedy=remedy)
