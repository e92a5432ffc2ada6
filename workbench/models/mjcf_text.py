"""An MJCF file as its author wrote it, in which numbers of joints, tendons and bodies can be replaced."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.core.xml_text import Element, XmlText

from .file_number import Inertial

#: Where a ``<joint name=...>`` is no joint, but names one.
_NO_TREE = {"default", "equality", "tendon", "actuator", "sensor"}
_TURNED = "axisangle", "xyaxes", "zaxis", "euler"
_SAME = 1e-12  # of the largest number of its kind


class MjcfText:
    """An MJCF file and the changes to make in it.

    Attributes:
        numbers: of a joint that it has a place for.
    """

    numbers = frozenset({"damping", "frictionloss", "armature", "stiffness"})

    def __init__(self, text: XmlText) -> None:
        self._text = text

    def has(self, name: str, kind: str = "joint") -> bool:
        """Return whether the file has this joint or fixed tendon."""
        return self._named(name, kind) is not None

    def set_numbers(self, name: str, values: Mapping[str, float], kind: str = "joint") -> None:
        """Set numbers of a joint or a fixed tendon, in the file's units, by attribute name.

        Of a damping or stiffness by powers of the speed or angle, the linear one.
        """
        element = self._named(name, kind)
        assert element is not None
        rest = {name: (element.get(name) or "").split()[1:] for name in values}
        self._text.set(element, {name: " ".join([digits(v), *rest[name]]) for name, v in values.items()})

    def set_body(self, joint: str, before: Inertial, after: Inertial, frame: np.ndarray) -> None:
        """Set mass, centre and inertia of the body that a joint carries.

        Args:
            joint: its name.
            before: what MuJoCo takes from the file.
            after: what it shall take from it.
            frame: axes (3, 3) of the inertia before, in the body's frame.

        Raises:
            InputError: the body, or what states its inertia, stands in another file.
        """
        element = self._named(joint, "joint")
        assert element is not None
        body = next((each for each in element.around() if each.tag == "body"), None)
        stated = None if body is None else body.child("inertial")
        if body is None or (stated is None and any(each.tag == "include" for each in body.children)):
            raise InputError(
                f"joint '{joint}' and the inertia of its body are in different files",
                file=self._text.file, remedy="put the joint and the <inertial> of its body into one file",
            )  # fmt: skip
        if stated is None:  # it came from geoms
            behind = element if element.parent is body else body.children[0]
            values = {"pos": row(after.centre), "mass": digits(after.mass)}
            values["fullinertia"] = row(_six(after.tensor))
            self._text.add_after(behind, "inertial", values)
            return
        if differ(before.centre, after.centre):
            self._text.set(stated, {"pos": row(after.centre)})
        if differ(before.mass, after.mass):
            self._text.set(stated, {"mass": digits(after.mass)})
        if differ(before.tensor, after.tensor):
            self._text.set(stated, _inertia(stated, after.tensor, frame))

    def _named(self, name: str, kind: str) -> Element | None:
        tag, elsewhere = ("fixed", {"default"}) if kind == "tendon" else (kind, _NO_TREE)
        return next(
            (
                each
                for each in self._text.elements
                if each.tag == tag
                and each.get("name") == name
                and not any(outer.tag in elsewhere for outer in each.around())
            ),
            None,
        )


def _inertia(stated: Element, tensor: np.ndarray, frame: np.ndarray) -> dict[str, str | None]:
    """Return attributes of an ``<inertial>`` in the form that the file uses."""
    if stated.get("fullinertia") is not None:
        return {"fullinertia": row(_six(tensor))}
    here = frame.T @ tensor @ frame
    if not differ(here, np.diag(np.diag(here))):
        return {"diaginertia": row(np.diag(here))}
    if not any(stated.get(name) for name in ("quat", *_TURNED)):
        return {"diaginertia": None, "fullinertia": row(_six(tensor))}
    principal, axes = np.linalg.eigh(tensor)
    axes *= np.sign(np.linalg.det(axes))
    return {"diaginertia": row(principal), "quat": row(_quaternion(axes)), **dict.fromkeys(_TURNED)}


def _six(tensor: np.ndarray) -> np.ndarray:
    """Return the diagonal, then xy, xz, yz, in the order of ``fullinertia``."""
    return tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def _quaternion(axes: np.ndarray) -> np.ndarray:
    out = np.zeros(4)
    mujoco.mju_mat2Quat(out, axes.ravel())
    return out


def differ(one: np.ndarray | float, other: np.ndarray | float) -> bool:
    """Return whether two numbers, or two arrays, differ by more than rounding."""
    a, b = np.abs(one).max(), np.abs(other).max()
    return bool(np.abs(np.subtract(one, other)).max() > _SAME * max(a, b))


def digits(value: float) -> str:
    """Return a number as written: twelve digits, without digits that are only rounding."""
    return f"{value + 0.0:.12g}"


def row(values: np.ndarray) -> str:
    """Return numbers as written; rounding errors beside the largest become 0."""
    least = _SAME * np.max(np.abs(values))
    return " ".join(digits(v if abs(v) > least else 0.0) for v in map(float, values))
