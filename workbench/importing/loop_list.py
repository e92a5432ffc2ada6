"""Loops of a URDF that a YAML file beside it lists, as in Gepetto/example-parallel-robots.

``closed_loop`` has pairs of frames (names of links, or of joints, which mean the link behind them), ``type``
whether points coincide (``3d``) or whole frames (``6d``, where nothing is said), ``name_mot`` the joints that
motors turn, and ``joint_name`` with ``joint_type`` those that a URDF cannot have: ``SPHERICAL``,
``UJOINT_XY`` and its like, ``FIXED``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal
from xml.etree import ElementTree

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from workbench.core import InputError
from workbench.core.coupling import couplings_in
from workbench.core.xml import parse_xml

from .converted import Converted
from .efforts import efforts_in
from .resistance import resistance_in

_AXES = {"X": "1 0 0", "Y": "0 1 0", "Z": "0 0 1"}
_ARM = 0.1  # m between the points that hold two frames together
_MASS, _INERTIA = "1e-9", "1e-12"  # kg, kg m^2 of a link between two turns of one joint
_SIDES = "ixx", "iyy", "izz", "ixy", "ixz", "iyz"
_LARGEST = 1 << 20  # bytes


def _lower(value: Any) -> Any:
    return value.lower() if isinstance(value, str) else value


class _Listed(BaseModel):
    """The YAML file; what else it says is not read."""

    model_config = ConfigDict(extra="ignore")

    closed_loop: list[tuple[str, str]]
    type: list[Annotated[Literal["3d", "6d"], BeforeValidator(_lower)]] = Field(default_factory=list)
    name_mot: list[str] = Field(default_factory=list)
    joint_name: list[str] = Field(default_factory=list)
    joint_type: list[str] = Field(default_factory=list)


@dataclass(frozen=True)
class LoopList:
    """What such a file says.

    Attributes:
        file: it.
        loops: pairs of frames, and whether whole frames coincide.
        motors: joints that motors turn.
        kinds: joint -> axes that it turns about one after the other, empty where it is fixed.
    """

    file: Path
    loops: tuple[tuple[str, str, bool], ...]
    motors: tuple[str, ...]
    kinds: dict[str, str]


def loop_list(file: Path) -> LoopList | None:
    """Return the list of loops beside a URDF: of its name, else the only one in its folder; or None.

    Raises:
        InputError: there is one that says what is not understood here.
    """
    if file.suffix.lower() != ".urdf" or not file.parent.is_dir():
        return None
    found = {own: text for own in sorted(file.parent.iterdir()) if (text := _text(own)) is not None}
    same = [own for own in found if own.stem == file.stem]
    if not same and len(found) != 1:
        return None
    own = (same or list(found))[0]
    try:
        listed = _Listed.model_validate(yaml.safe_load(found[own]))
    except yaml.YAMLError as error:
        said = " ".join(str(error).split())
        raise InputError(f"is no YAML: {said}", file=own, remedy="correct what it names") from error
    except (ValidationError, RecursionError) as error:
        first = (
            error.errors()[0]
            if isinstance(error, ValidationError)
            else {"loc": (), "msg": "is nested too deeply"}
        )
        raise InputError(
            str(first["msg"]).lower(), file=own, column=".".join(map(str, first["loc"])),
            remedy="give closed_loop, a list of pairs of frames, and type, 3d or 6d each",
        ) from error  # fmt: skip
    for key, one, other in (("type", listed.type or listed.closed_loop, listed.closed_loop),
                            ("joint_type", listed.joint_type, listed.joint_name)):  # fmt: skip
        if len(one) != len(other):
            raise InputError(
                f"{len(one)} entries for {len(other)}", file=own, column=key, remedy="give one each"
            )
    whole = [kind == "6d" for kind in listed.type] or [True] * len(listed.closed_loop)
    loops = tuple((a, b, each) for (a, b), each in zip(listed.closed_loop, whole, strict=True))
    kinds = {n: _axes(k, own) for n, k in zip(listed.joint_name, listed.joint_type, strict=True)}
    return LoopList(own, loops, tuple(listed.name_mot), kinds)


def with_list(file: Path, listed: LoopList) -> Converted:
    """Return the URDF with the list's joints and frames where its loops close; shapes are left out.

    Raises:
        InputError: the file is no URDF, or has no joint or frame of a name in the list.
    """
    root = parse_xml(
        file.read_bytes(), file, prefixes=False, problem="not an XML file", remedy="give a URDF file"
    )
    for link in root.iter("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    joints = {joint.get("name", ""): joint for joint in root.findall("joint")}
    links = {link.get("name", "") for link in root.findall("link")}
    behind = {name: _end(joint) for name, joint in joints.items()}
    for name in listed.motors:
        if name not in joints:
            raise InputError(
                f"'{name}' is not a joint of {file.name}", file=listed.file, remedy="name joints of the URDF"
            )
    pairs: list[tuple[str, str]] = []
    for number, (first, second, whole) in enumerate(listed.loops):
        ends = []
        for name in (first, second):
            if name not in links and name not in behind:
                raise InputError(
                    f"'{name}' is not a frame of {file.name}", file=listed.file, column="closed_loop",
                    remedy="name links or joints of the URDF",
                )  # fmt: skip
            ends.append(name if name in links else behind[name])
        corners = ("0 0 0", f"{_ARM} 0 0", f"0 {_ARM} 0") if whole else ("0 0 0",)
        for k, corner in enumerate(corners):
            made = [f"loop{number}{'_' + str(k) if k else ''}_{side}" for side in "ab"]
            for name, link in zip(made, ends, strict=True):
                _point(root, name, link, corner)
            pairs.append((made[0], made[1]))
    for name, axes in listed.kinds.items():
        if name in joints:  # of a robot of which the URDF has one half, say
            _turn(root, joints[name], axes)
    return Converted(
        ElementTree.tostring(root, encoding="unicode") + "\n", ".urdf", tuple(pairs), len(listed.loops),
        couplings=couplings_in(root, file), motors=listed.motors, said_by=listed.file.name,
        torque_limit=efforts_in(root, file), **resistance_in(root, file),
    )  # fmt: skip


def _text(file: Path) -> str | None:
    """Of a YAML file that lists loops, else None."""
    if file.suffix.lower() not in (".yaml", ".yml") or not file.is_file() or file.stat().st_size > _LARGEST:
        return None
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
    return text if any(line.startswith("closed_loop") for line in text.splitlines()) else None


def _axes(kind: str, file: Path) -> str:
    name = kind.upper()
    axes = (
        name.removeprefix("UJOINT_")
        if name.startswith("UJOINT_")
        else {"SPHERICAL": "XYZ", "FIXED": ""}.get(name)
    )
    if axes is None or any(axis not in _AXES for axis in axes) or (name.startswith("U") and len(axes) != 2):
        raise InputError(
            f"a joint of type '{kind}'", file=file, column="joint_type",
            remedy="known are SPHERICAL, UJOINT_XY (two of X, Y, Z) and FIXED",
        )  # fmt: skip
    return axes


def _end(joint: ElementTree.Element) -> str:
    child = joint.find("child")
    return "" if child is None else child.get("link", "")


def _point(root: ElementTree.Element, name: str, link: str, at: str) -> None:
    ElementTree.SubElement(root, "link", name=name)
    joint = ElementTree.SubElement(root, "joint", name=f"{name}_fixed", type="fixed")
    ElementTree.SubElement(joint, "parent", link=link)
    ElementTree.SubElement(joint, "child", link=name)
    ElementTree.SubElement(joint, "origin", xyz=at, rpy="0 0 0")


def _turn(root: ElementTree.Element, joint: ElementTree.Element, axes: str) -> None:
    """Make of one joint as many as it has axes, with links of next to no mass between them."""
    name, child = joint.get("name", ""), joint.find("child")
    for old in (*joint.findall("axis"), *joint.findall("limit"), *joint.findall("mimic")):
        joint.remove(old)
    if not axes:
        joint.set("type", "fixed")
        return
    assert child is not None
    last = child.get("link", "")
    for k, axis in enumerate(axes):
        own = joint if k == 0 else ElementTree.SubElement(root, "joint")
        own.set("name", f"{name}_{axis}")
        own.set("type", "continuous")
        ElementTree.SubElement(own, "axis", xyz=_AXES[axis])
        end = last if k == len(axes) - 1 else f"{name}_{axis}_link"
        if k == 0:
            child.set("link", end)
        else:
            ElementTree.SubElement(own, "parent", link=f"{name}_{axes[k - 1]}_link")
            ElementTree.SubElement(own, "child", link=end)
        if end != last:
            inertial = ElementTree.SubElement(ElementTree.SubElement(root, "link", name=end), "inertial")
            ElementTree.SubElement(inertial, "mass", value=_MASS)
            sizes = {key: _INERTIA if key[1] == key[2] else "0" for key in _SIDES}
            ElementTree.SubElement(inertial, "inertia", sizes)
