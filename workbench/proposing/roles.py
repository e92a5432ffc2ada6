"""Columns whose names state the joint and whether they are commands, but not the quantity."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .match import follows
from .names import Role

_ALIKE = 0.9
#: Words for what a drive gives: of such a column without a quantity or unit, a torque.
_DRIVE = ("drive", "drv", "servo", "amplifier", "out", "output")


def pairs(data: dict[str, np.ndarray], roles: dict[str, Role]) -> dict[str, tuple[str, str]]:
    """Return joint -> position and its reference, as ``A1 act`` and ``A1 set``, if most follow theirs.

    Args:
        data: column -> finite values (N,).
        roles: column -> what its name says.
    """
    by_joint: dict[str, dict[str, list[str]]] = {}
    for name in data:
        role = roles[name]
        if not role.kind and role.role in ("measured", "reference"):
            by_joint.setdefault(role.joint, {}).setdefault(role.role, []).append(name)
    found = {
        joint: (by["measured"][0], by["reference"][0])
        for joint, by in by_joint.items()
        if {r: len(names) for r, names in by.items()} == {"measured": 1, "reference": 1}
    }
    # "A1 drive set" is beside "A1 set" no reference of a position
    found = {j: pair for j, pair in found.items() if _base(j) == j or _base(j) not in found}
    alike = [is_reference(data[asked], data[seen]) for seen, asked in found.values()]
    return found if 2 * sum(alike) > len(found) else {}


def is_reference(asked: np.ndarray, seen: np.ndarray) -> bool:
    """Return whether a column may be the reference of a position; both shape (N,), finite."""
    relation = follows(asked, seen)
    return relation.likeness > _ALIKE and 0.5 < relation.factor < 2.0 and relation.lag >= 0


def is_held_reference(asked: np.ndarray, seen: np.ndarray) -> bool:
    """Return whether a constant column may be the reference at which a position is held."""
    return bool(abs(asked[0] - seen.mean()) <= np.ptp(seen) + 0.05 * abs(asked[0]))


def drives(free: list[str], roles: dict[str, Role], joints: list[str]) -> Iterator[tuple[str, str, str]]:
    """Return signal, joint and column of drive torques or commands; ``torque`` if names do not say which.

    Args:
        free: columns without a meaning.
        roles: column -> what its name says.
        joints: those of the positions.
    """
    signals = {"measured": "torque_measured", "reference": "torque_command"}
    for name in free:
        role = roles[name]
        words = [w for w in role.words if w in _DRIVE]
        if role.kind or not words or not (role.role in signals or "out" in words or "output" in words):
            continue
        joint = role.joint if role.joint in joints else _base(role.joint)
        if joint in joints:
            yield signals.get(role.role, "torque"), joint, name


def _base(joint: str) -> str:
    return "_".join(word for word in joint.split("_") if word not in _DRIVE)
