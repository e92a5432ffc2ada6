"""What a file holds, for the person who has to say which joint is what."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.coupling import couplings_in
from workbench.core.xml import parse_xml
from workbench.mechanism.parse import GRAVITY, declared_loops, finished, parse

from .converted import Beside
from .efforts import efforts_in
from .opened import opened
from .resistance import resistance_in


@dataclass(frozen=True)
class Contents(Beside):
    """Names in an SDF, URDF or MJCF file.

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
        """Joints and frames on two lines, and what the file binds beside its tree."""
        lines = [f"joints: {', '.join(self.joints)}", f"frames: {', '.join(self.frames)}", *self.bonds]
        lines += [f"motors: {', '.join(self.motors)}"] if self.motors else []
        lines += [f"springs: {', '.join(self.springs)}"] if self.springs else []
        return "\n".join(lines)

    @property
    def bonds(self) -> list[str]:
        """Return a line each for what the file binds beside its tree; empty for a plain tree."""
        follow = [
            f"{c.joint} follows {c.follows}" if c.follows else f"{c.joint} is held" for c in self.couplings
        ]
        where = f" ({self.said_by})" if self.said_by else ""
        said = [f"loops that it closes: {self.loops}{where}"] if self.loops else []
        said += [f"couplings: {', '.join(follow)}"] if follow else []
        if self.round_rods:
            said.append(
                "ball joints of rods, taken as not turning about their own axis: "
                f"{', '.join(self.round_rods)}"
            )
        if abs(self.gravity - GRAVITY) > 1e-6:
            said.append(f"gravity of {self.gravity:g} m/s^2 is taken as {GRAVITY:g}")
        return said


def contents_of(file: Path) -> Contents:
    """Read a file's names.

    Raises:
        InputError: it cannot be read.
    """
    with opened(file) as (source, converted):
        found = _contents(source, converted.closed if converted else len(declared_loops(source)))
        if converted is None:
            root = parse_xml(source.read_bytes(), source, prefixes=False)
            return replace(
                found,
                couplings=couplings_in(root, source),
                torque_limit=efforts_in(root, source),
                **resistance_in(root, source),
            )
        return replace(found, **{f.name: getattr(converted, f.name) for f in fields(Beside)})


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
