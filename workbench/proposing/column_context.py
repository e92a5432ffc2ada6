"""What other columns show about a column: a joint that was held, a position that belongs to no joint."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from .names import KINDS, Role


def held(still: Collection[str], moving: Collection[str], roles: Mapping[str, Role]) -> set[str]:
    """Return constant columns that belong to a joint, as columns with the same words do to others.

    An axis that was held while another one was moved has such columns, with an encoder of coarse steps.

    Args:
        still, moving: columns that never change, and those that do.
        roles: column -> what its name says.
    """
    known = {_family(roles[name]) for name in moving if roles[name].kind}
    return {name for name in still if roles[name].kind and _family(roles[name]) in known}


def without_joint(joints: Sequence[str], others: Collection[str]) -> list[str]:
    """Return numbered positions without other signals, if other positions have a velocity or torque.

    Those of a tool, ``ee_pos[0]`` beside ``q[0]`` and ``tau[0]``, are numbered as joints are.

    Args:
        joints: of all positions.
        others: of which there is another signal.
    """
    groups: dict[str, list[str]] = {}
    for joint in joints:
        groups.setdefault(re.sub(r"_?\d+$", "", joint), []).append(joint)
    alone = [g for g in groups.values() if len(g) > 1 and not set(g) & set(others)]
    out = [joint for group in alone for joint in group]
    return out if len(out) < len(joints) else []


def with_kinds(roles: Sequence[Role]) -> list[Role]:
    """Return the roles, with a kind for names that differ only in their role from names whose unit says it.

    ``M_soll_S`` beside ``M_ist_S [Nm]`` is a torque that was asked for.
    """
    kinds: dict[str, set[str]] = {}
    for role in roles:
        by_unit = role.unit and not any(word in KINDS.get(role.kind, ()) for word in role.words)
        if by_unit and role.role and role.joint:
            kinds.setdefault(role.joint, set()).add(role.kind)
    out = list(roles)
    for i, role in enumerate(roles):
        alike = kinds.get(role.joint, set())
        if role.role and not role.kind and not role.unit and len(alike) == 1:
            out[i] = replace(role, kind=next(iter(alike)))
    return out


def _family(role: Role) -> tuple[str, str, tuple[str, ...]]:
    own = set(role.joint.split("_"))
    return role.kind, role.role, tuple(word for word in role.words if word not in own)
