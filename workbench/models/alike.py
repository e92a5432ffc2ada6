"""Joints of a robot with the same design: left and right, front and rear."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from .model import Model
from .spec import load_tree

_DIGITS = 6  # to which numbers of a file are the same; mirrored links differ in signs alone


def alike_axes(model: Model) -> tuple[tuple[str, ...], ...]:
    """Return groups of two or more axes whose joints and links have the same numbers in the model's file.

    Joint kind, how many joints before it, armature, damping, dry friction, mass, principal inertia and the
    size of each coordinate of its centre. Drives that turn several joints are alike to none.
    """
    kinds = _kinds(model.serial, tuple(model.joints))
    own = [bool((row == np.eye(model.size)[i]).all()) for i, row in enumerate(model.transmission)]
    groups: dict[tuple, list[str]] = {}
    for axis, kind, alone in zip(model.axes, kinds, own, strict=True):
        if alone:
            groups.setdefault(kind, []).append(axis)
    return tuple(tuple(axes) for axes in groups.values() if len(axes) > 1)


@lru_cache(maxsize=64)
def _kinds(serial: Path, joints: tuple[str, ...]) -> tuple[tuple, ...]:
    m = load_tree(serial).compile()
    bodies = [int(m.joint(name).bodyid[0]) for name in joints]
    out = []
    for name, body in zip(joints, bodies, strict=True):
        joint, dof = m.joint(name), int(m.joint(name).dofadr[0])
        before, above = 0, int(m.body_parentid[body])
        while above:
            before, above = before + bodies.count(above), int(m.body_parentid[above])
        numbers = [
            m.dof_armature[dof], m.dof_damping[dof], m.dof_frictionloss[dof], m.body_mass[body],
            *np.sort(m.body_inertia[body]), *np.abs(m.body_ipos[body]),
        ]  # fmt: skip
        out.append((int(joint.type[0]), before, *(f"{x:.{_DIGITS}g}" for x in numbers)))
    return tuple(out)
