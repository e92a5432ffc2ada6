"""A URDF file as its author wrote it, in which numbers of joints and links can be replaced."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from workbench.core.xml_text import Element, XmlText

from .file_number import Inertial
from .mjcf_text import differ, digits, row

_CALLED = {"damping": "damping", "frictionloss": "friction"}
_SIX = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}


class UrdfText:
    """A URDF file and the changes to make in it.

    Attributes:
        numbers: of a joint that it has a place for.
    """

    numbers = frozenset(_CALLED)

    def __init__(self, text: XmlText) -> None:
        self._text = text

    def has(self, name: str, kind: str = "joint") -> bool:
        """Return whether the file has this joint; a URDF has no tendons."""
        return self._named(kind, name) is not None

    def set_numbers(self, name: str, values: Mapping[str, float], kind: str = "joint") -> None:
        """Set numbers of a joint by their MJCF names."""
        element = self._named(kind, name)
        assert element is not None
        self._part(element, "dynamics", {_CALLED[name]: digits(v) for name, v in values.items()})

    def set_body(self, joint: str, before: Inertial, after: Inertial, frame: np.ndarray) -> None:
        """Set mass, centre and inertia of the link behind a joint.

        Args:
            joint: its name.
            before: what MuJoCo takes from the file.
            after: what it shall take from it.
            frame: not asked: the file says how its inertia is turned.
        """
        del frame
        element = self._named("joint", joint)
        child = None if element is None else element.child("child")
        link = None if child is None else self._named("link", child.get("link") or "")
        inertial = None if link is None else link.child("inertial")
        assert inertial is not None  # a link that has none has no mass, and no effect applies to it
        if differ(before.centre, after.centre):
            self._part(inertial, "origin", {"xyz": row(after.centre)})
        if differ(before.mass, after.mass):
            self._part(inertial, "mass", {"value": digits(after.mass)})
        if differ(before.tensor, after.tensor):
            origin = inertial.child("origin")
            turn = np.array(((origin.get("rpy") if origin else None) or "0 0 0").split(), float)
            axes = _axes(turn)
            there = row((axes.T @ after.tensor @ axes).ravel()).split()
            self._part(inertial, "inertia", {name: there[3 * i + j] for name, (i, j) in _SIX.items()})

    def _part(self, element: Element, tag: str, values: Mapping[str, str]) -> None:
        """Return attributes of a child element, which is created if it is missing."""
        part = element.child(tag)
        if part is None:
            self._text.add_after(element.children[-1], tag, values)
        else:
            self._text.set(part, values)

    def _named(self, tag: str, name: str) -> Element | None:
        named = (each for each in self._text.root.children if each.tag == tag and each.get("name") == name)
        return next(named, None)


def _axes(turn: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3) for roll, pitch and yaw (3,) [rad] about fixed axes, in this order."""
    quaternion, flat = np.zeros(4), np.zeros(9)
    mujoco.mju_euler2Quat(quaternion, turn, "XYZ")
    mujoco.mju_quat2Mat(flat, quaternion)
    return flat.reshape(3, 3)
