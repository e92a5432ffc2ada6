"""Damping and dry friction that a URDF or SDF states at its joints (``<dynamics>``)."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict
from xml.etree import ElementTree

from workbench.core import InputError


class Resistance(TypedDict):
    """Joint -> damping [N m s/rad or N s/m] and dry friction [N m or N], where it is not zero."""

    damping: dict[str, float]
    friction: dict[str, float]


def resistance_in(root: ElementTree.Element, file: Path) -> Resistance:
    """Return what the joints of a file's XML state.

    Raises:
        InputError: a value that is no number of zero or more.
    """

    def stated(key: str) -> dict[str, float]:
        return {
            joint.get("name", ""): value
            for joint in root.iter("joint")
            for dynamics in joint.iter("dynamics")
            if (value := _number(joint.get("name", ""), dynamics, key, file))
        }

    return {"damping": stated("damping"), "friction": stated("friction")}


def _number(joint: str, dynamics: ElementTree.Element, key: str, file: Path) -> float:
    text = dynamics.get(key) or dynamics.findtext(key) or "0"  # URDF has attributes where SDF has elements
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0.0 <= value < float("inf"):
        raise InputError(
            f"joint '{joint}' has a {key} of '{text.strip()}'", file=file, column="dynamics",
            remedy="give a number of zero or more",
        )  # fmt: skip
    return value
