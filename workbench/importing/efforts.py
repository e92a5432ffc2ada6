"""Torque limits that a URDF or SDF states at its joints (``effort`` of a ``<limit>``)."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from workbench.core import InputError


def efforts_in(root: ElementTree.Element, file: Path) -> dict[str, float]:
    """Return joint -> torque limit [N m, or N along a line] of a file's XML, for joints that have one.

    A URDF has to state an effort at every hinge, so that those who know none write 0; in SDF a negative
    number says that there is none. Neither is a limit: no motor has a torque of zero.

    Raises:
        InputError: an effort that is no number.
    """
    out = dict[str, float]()
    for joint in root.iter("joint"):
        for limit in joint.iter("limit"):
            text = limit.get("effort") or limit.findtext("effort") or "0"  # URDF: attribute, SDF: element
            try:
                value = float(text)
            except ValueError:
                value = float("nan")
            if value != value:
                raise InputError(
                    f"joint '{joint.get('name', '')}' has an effort of '{text.strip()}'", file=file,
                    column="limit", remedy="give a number, 0 for none",
                )  # fmt: skip
            if 0.0 < value < float("inf"):
                out[joint.get("name", "")] = value
    return out
