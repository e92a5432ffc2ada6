"""What a file holds, for the person who has to say which joint is what."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.mechanism.parse import declared_loops, finished, parse

from .from_mjcf import opened


@dataclass(frozen=True)
class Contents:
    """Names in an SDF, URDF or MJCF file.

    Attributes:
        joints: names of joints that move.
        frames: names of frames, links included.
        loops: number of loops that the file itself closes.
        limits: joint -> lower and upper limit where the file states both [rad or m].
        armature, damping, torque_limit: joint -> what an MJCF has there; empty for other files.
    """

    joints: tuple[str, ...]
    frames: tuple[str, ...]
    loops: int
    limits: dict[str, tuple[float, float]]
    armature: dict[str, float] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    torque_limit: dict[str, float] = field(default_factory=dict)

    def __str__(self) -> str:
        """Joints and frames on two lines."""
        return f"joints: {', '.join(self.joints)}\nframes: {', '.join(self.frames)}"


def contents_of(file: Path) -> Contents:
    """Read a file's names.

    Raises:
        InputError: it cannot be read.
    """
    with opened(file) as (source, converted):
        found = _contents(source, len(converted.loops if converted else declared_loops(source)))
        if converted is None:
            return found
        own = (converted.armature, converted.damping, converted.torque_limit)
        return replace(found, **dict(zip(("armature", "damping", "torque_limit"), own, strict=True)))


def _contents(file: Path, loops: int) -> Contents:
    plant, model = parse(file)
    finished(plant, file)
    joints: list[str] = []
    limits: dict[str, tuple[float, float]] = {}
    for index in plant.GetJointIndices(model):
        joint: Any = plant.get_joint(index)
        if joint.num_positions() == 0:
            continue
        joints.append(joint.name())
        low, high = joint.position_lower_limits(), joint.position_upper_limits()
        if joint.num_positions() == 1 and np.isfinite([low[0], high[0]]).all():
            limits[joint.name()] = (float(low[0]), float(high[0]))
    frames = [plant.get_frame(i).name() for i in plant.GetFrameIndices(model)]
    made_by_drake = ("_parent", "_child", "__model__", "_F", "_M")
    shown = [name for name in frames if not name.endswith(made_by_drake)]
    return Contents(tuple(joints), tuple(shown), loops, limits)
