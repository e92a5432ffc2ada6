"""Joints with the name of a quantity, such as ``effort``, ``time`` or ``load``: other columns show it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from .names import KINDS, Role, role_of

_MOTION = ("position", "velocity", "torque")
#: What people write beside a quantity that names no joint.
_PLAIN = ("state", "enc", "encoder")
_LONG = 4  # letters of a word that a joint is called by; shorter ones are symbols


def joints_like_quantities(names: Sequence[str]) -> dict[str, Role]:
    """Return column -> meaning of its name without the word that is the name of its joint.

    A word for a quantity is a joint's name where the rest of its columns' names tells a position and more of
    the motion: ``q_effort``, ``dq_effort`` and ``tau_effort`` are three quantities of one joint.

    Args:
        names: of all columns.
    """
    out: dict[str, Role] = {}
    words = {w for kind in KINDS.values() for w in kind if len(w) >= _LONG and w not in _PLAIN}
    own = {name: role_of(name) for name in names}
    for word in sorted(words):
        rest = {name: _without(name, word) for name in names if word in own[name].words}
        told = {name: role_of(text) for name, text in rest.items() if text}
        plain = {role.kind for role in told.values() if set(role.words) & set(KINDS.get(role.kind, ()))}
        if "position" not in plain or len(plain & set(_MOTION)) < 2:
            continue
        for name, role in told.items():
            out[name] = replace(role, joint="_".join(filter(None, (role.joint, word))))
    return out


def _without(name: str, word: str) -> str:
    return re.sub(rf"(?<![a-z]){word}(?![a-z])", "", name, flags=re.IGNORECASE).strip("._/- ")
