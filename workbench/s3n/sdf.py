"""The numbers of an SDF file: links, joints and frames of a tree, read with the standard library alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError
from workbench.core.xml import parse_xml

_WORLD = ("world", "__model__", "")
_KINDS = ("revolute", "continuous", "prismatic", "universal", "fixed")


@dataclass(frozen=True)
class Pose:
    """A place in another frame: rotation (3, 3) and position (3,) [m]."""

    turn: np.ndarray
    at: np.ndarray

    def then(self, inner: Pose) -> Pose:
        """Return a pose that is given in this frame, in this frame's own parent frame."""
        return Pose(self.turn @ inner.turn, self.at + self.turn @ inner.at)

    def back(self) -> Pose:
        """Return the inverse: the parent frame seen from this frame."""
        return Pose(self.turn.T, -self.turn.T @ self.at)


HERE = Pose(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Link:
    """A link: `place` in the model's frame at joint angles zero; the rest in the link's frame.

    `mass` [kg], `centre` (3,) [m], `inertia` (3, 3) about the centre of mass [kg m^2].
    """

    name: str
    place: Pose
    mass: float
    centre: np.ndarray
    inertia: np.ndarray


@dataclass(frozen=True)
class Joint:
    """A joint: `kind` as in SDF, `place` in the child's frame.

    `coordinates`: (name, axis) of each, the parent's first, axis (3,) in the joint's frame; a joint with more
    than one (a universal joint) has coordinates named after it, ``rod_qx`` and ``rod_qy``.
    """

    name: str
    kind: str
    parent: str | None
    child: str
    place: Pose
    coordinates: tuple[tuple[str, np.ndarray], ...]


@dataclass(frozen=True)
class Frame:
    """A frame on a link; `place` in the link's frame."""

    name: str
    link: str | None
    place: Pose


@dataclass(frozen=True)
class SdfTree:
    """What an SDF file holds; None for a link means the world."""

    file: Path
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...]

    @property
    def mass(self) -> float:
        """Return the sum of the links' masses [kg]."""
        return sum(link.mass for link in self.links)

    def frame(self, name: str) -> Frame:
        """Return a frame, or a link's own frame, by name.

        Raises:
            InputError: there is none.
        """
        for frame in self.frames:
            if frame.name == name:
                return frame
        for link in self.links:
            if link.name == name:
                return Frame(name, name, HERE)
        names = ", ".join(f.name for f in self.frames)
        raise InputError(f"no frame is called '{name}'", file=self.file, remedy=f"frames are {names}")


def read_sdf(file: Path) -> SdfTree:
    """Return the first model of an SDF file.

    Raises:
        InputError: not an SDF file, or something in it that a tree of hinges and slides has not.
    """
    try:
        root = parse_xml(file.read_bytes(), file, problem="not an SDF file")
    except OSError as error:
        raise InputError(f"not an SDF file: {error}", file=file, remedy="give an SDF file") from error
    model = root.find(".//model")
    if root.tag != "sdf" or model is None:
        raise InputError("not an SDF file with a model", file=file, remedy="give an SDF file")
    try:
        return _Reader(file, model).read()
    except (ValueError, KeyError) as error:
        raise InputError(f"cannot be read: {error}", file=file, remedy="see the SDF specification") from error


class _Reader:
    """Resolves poses, which may be given relative to any link, joint or frame."""

    def __init__(self, file: Path, model: ElementTree.Element) -> None:
        self.file, self.model = file, model
        self.found = {
            (e.get("name") or ""): e for kind in ("frame", "joint", "link") for e in model.findall(kind)
        }
        self.placed: dict[str, Pose] = {}

    def read(self) -> SdfTree:
        links = tuple(self._link(e) for e in self.model.findall("link"))
        joints = tuple(self._joint(e) for e in self.model.findall("joint"))
        frames = tuple(self._frame(e) for e in self.model.findall("frame"))
        return SdfTree(self.file, links, (*joints, *based(links, joints)), frames)

    def _place(self, name: str) -> Pose:
        """Return the pose of a named element in the model's frame."""
        if name in _WORLD:
            return HERE
        if name not in self.placed:
            if name not in self.found:
                raise ValueError(f"nothing is called '{name}'")
            element = self.found[name]
            self.placed[name] = HERE  # ends a chain of poses that refer to each other
            default = {"joint": _text(element, "child"), "frame": element.get("attached_to", "")}
            pose = element.find("pose")
            given = pose.get("relative_to") if pose is not None else None
            outer = self._place(given if given is not None else default.get(element.tag, ""))
            self.placed[name] = outer.then(_pose(pose))
        return self.placed[name]

    def _link(self, element: ElementTree.Element) -> Link:
        name, inertial = element.get("name") or "", element.find("inertial")
        mass = float(_text(inertial, "mass", "0")) if inertial is not None else 0.0
        if inertial is None or mass == 0.0:
            return Link(name, self._place(name), 0.0, np.zeros(3), np.zeros((3, 3)))
        own = _pose(inertial.find("pose"))
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        xx, yy, zz, xy, xz, yz = (float(_text(inertial, f"inertia/{k}", "0")) for k in keys)
        about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return Link(name, self._place(name), mass, own.at, own.turn @ about @ own.turn.T)

    def _joint(self, element: ElementTree.Element) -> Joint:
        name, kind = element.get("name") or "", element.get("type") or ""
        if kind not in _KINDS:
            raise InputError(
                f"joint '{name}' is of type '{kind}'", file=self.file,
                remedy=f"joints may be {', '.join(_KINDS)}",
            )  # fmt: skip
        parent, child = _text(element, "parent"), _text(element, "child")
        place = self._place(child).back().then(self._place(name))
        suffixes = {"universal": (("_qx", "axis"), ("_qy", "axis2")), "fixed": ()}.get(kind, (("", "axis"),))
        coordinates = tuple((name + suffix, self._axis(element, key)) for suffix, key in suffixes)
        return Joint(name, kind, None if parent in _WORLD else parent, child, place, coordinates)

    def _axis(self, element: ElementTree.Element, key: str) -> np.ndarray:
        """Return an axis (3,) in the joint's frame."""
        xyz = element.find(f"{key}/xyz")
        axis = np.array([float(x) for x in (_text(element, f"{key}/xyz", "0 0 1")).split()])
        expressed = xyz.get("expressed_in") if xyz is not None else None
        if expressed is None:
            return axis
        return self._place(element.get("name") or "").turn.T @ self._place(expressed).turn @ axis

    def _frame(self, element: ElementTree.Element) -> Frame:
        name, carrier = element.get("name") or "", element.get("attached_to") or ""
        seen = {name}
        while carrier not in _WORLD and self.found[carrier].tag == "frame" and carrier not in seen:
            seen.add(carrier)
            carrier = self.found[carrier].get("attached_to") or ""
        if carrier in _WORLD:
            return Frame(name, None, self._place(name))
        return Frame(name, carrier, self._place(carrier).back().then(self._place(name)))


def based(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """Return joints that fix links without a parent to the world, where they are."""
    held = {joint.child for joint in joints}
    names = sorted(link.name for link in links if link.name not in held)
    return tuple(Joint(f"{name}_base", "fixed", None, name, HERE, ()) for name in names)


def _text(element: ElementTree.Element | None, path: str, default: str = "") -> str:
    found = None if element is None else element.find(path)
    return (found.text or default).strip() if found is not None else default


def _pose(element: ElementTree.Element | None) -> Pose:
    if element is None or not (element.text or "").strip():
        return HERE
    numbers = [float(x) for x in (element.text or "").split()]
    if len(numbers) != 6 or element.get("rotation_format", "euler_rpy") != "euler_rpy":
        raise ValueError(f"pose '{element.text}' is not x y z roll pitch yaw")
    degrees = element.get("degrees", "false").lower() in ("true", "1")
    turn = Rotation.from_euler("xyz", numbers[3:], degrees=degrees).as_matrix()
    return Pose(turn, np.array(numbers[:3]))
