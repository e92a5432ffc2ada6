"""Two numbers of a model that are one: the inertia of a rotor, and that of the link that turns with it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np


def one_body(model: Path, drives: Sequence[str]) -> tuple[str, ...]:
    """Drives about whose axis the link turns just as fast as the rotor, so that no motion tells them apart.

    This is the first drive, and the second one where the first joint does not turn the second link about the
    second axis: where it slides, or its axis is at a right angle to the second one.

    Args:
        model: an MJCF file of a chain whose frames are parallel when all angles are zero.
        drives: their names, in the order of the joints.

    Raises:
        ValueError: the file is no MJCF.
    """
    try:
        world = ElementTree.parse(model).find("worldbody")
    except ElementTree.ParseError as error:
        raise ValueError(f"{model}: no MJCF: {error}") from error
    joints = [] if world is None else list(world.iter("joint"))
    if len(joints) < 2 or [joint.get("name") for joint in joints] != list(drives):
        return tuple(drives[:1])
    first, second = (np.array((joint.get("axis") or "0 0 1").split(), float) for joint in joints[:2])
    slides = [joint.get("type") == "slide" for joint in joints]
    apart = slides[0] or abs(float(first @ second)) < 1e-9
    return tuple(drives[: 2 if apart and not slides[1] else 1])
