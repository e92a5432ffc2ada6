"""What a file holds, for the person who has to say which joint is what."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.mechanism.parse import declared_loops, finished, parse


@dataclass(frozen=True)
class Contents:
    """Names in an SDF or URDF file.

    Attributes:
        joints: names of joints that move.
        frames: names of frames, links included.
        loops: number of loops that the file itself closes.
        limits: joint -> lower and upper limit where the file states both [rad or m].
    """

    joints: tuple[str, ...]
    frames: tuple[str, ...]
    loops: int
    limits: dict[str, tuple[float, float]]

    def __str__(self) -> str:
        """Joints and frames on two lines."""
        return f"joints: {', '.join(self.joints)}\nframes: {', '.join(self.frames)}"


def contents_of(file: Path) -> Contents:
    """Read a file's names.

    Raises:
        InputError: it cannot be read.
    """
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
    return Contents(tuple(joints), tuple(shown), len(declared_loops(file)), limits)
