"""Where a mechanism's loops close, as pairs of frames in Drake."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.tree import FixedOffsetFrame

from workbench.core import InputError, Mechanism

from .parse import declared_loops


def loop_pairs(plant: Any, model: Any, mechanism: Mechanism) -> list[tuple[Any, Any]]:
    """Pairs of frames whose origins coincide: those the mechanism names, then those the file declares.

    Args:
        plant: a plant that is not yet finalised; frames for declared loops are added to it.
        model: its model instance.
        mechanism: what is known beside the file.

    Raises:
        InputError: the file has no frame of that name.
    """
    pairs: list[tuple[Any, Any]] = [
        (
            find_frame(plant, model, mechanism, first, "loops"),
            find_frame(plant, model, mechanism, second, "loops"),
        )
        for first, second in mechanism.loops
    ]
    for number, loop in enumerate(declared_loops(mechanism.file)):
        ends: list[Any] = []
        for side, body, point in zip("AB", loop.bodies, loop.points, strict=True):
            at: Any = point
            parent = find_frame(plant, model, mechanism, body, "loops")
            ends.append(
                plant.AddFrame(FixedOffsetFrame(f"loop_{number}_{side}", parent, RigidTransform(at), model))
            )
        pairs.append((ends[0], ends[1]))
    return pairs


def find_frame(plant: Any, model: Any, mechanism: Mechanism, name: str, key: str) -> Any:
    """Drake's frame of this name; `key` is where a model file names it.

    Raises:
        InputError: the file has none; names those that it has.
    """
    if plant.HasFrameNamed(name, model):
        return plant.GetFrameByName(name, model)
    known = [plant.get_frame(i).name() for i in plant.GetFrameIndices(model)]
    made_by_drake = ("_parent", "_child", "__model__")
    raise InputError(
        f"the file has no frame '{name}'", file=mechanism.file, column=f"closed_chain.{key}",
        remedy=f"frames are {', '.join(n for n in known if not n.endswith(made_by_drake))}",
    )  # fmt: skip


def origin(frame: Any) -> np.ndarray:
    """Return where a frame's origin is in its body's frame (3,) [m]."""
    return frame.GetFixedPoseInBodyFrame().translation()
