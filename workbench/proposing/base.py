"""Pose of the base, for a model with a floating base: columns of its position and quaternion."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from workbench.core import InputError

from .draft import Draft
from .names import role_of

#: What a recording says of a base that floats, and how many columns each has.
BASE = {"base_position": 3, "base_orientation": 4, "base_velocity": 3, "base_angular_velocity": 3}
_ENDS = re.compile(r"(.*?)[^a-z0-9]?(q?)([wxyz])\]?")
_RATES = {"velocity", "acceleration", "torque"}
_OTHERS = {"gyro", "angular", "omega", "euler", "rpy", "gravity", "mag", "foot", "contact"}
_UNIT = 0.05  # by which the length of a quaternion may be off


def base_columns(draft: Draft) -> dict[str, list[str]]:
    """Return the columns of each of `BASE` that is stated or, for the pose, found by names and numbers.

    Rates are taken only where they are stated: no name tells along which axes they were taken.

    Raises:
        InputError: another number of columns than one has.
    """
    stated = {
        signal: list(draft.answers.columns[signal]) for signal in BASE if signal in draft.answers.columns
    }
    for signal, names in stated.items():
        if len(names) != BASE[signal]:
            raise InputError(
                f"{signal} has {BASE[signal]} columns, not {len(names)}", file=draft.table.file,
                remedy=f"give --column {signal}={','.join(_letters(signal))}",
            )  # fmt: skip
    if not draft.answers.floats:
        return stated
    found = stated if "base_position" in stated else _pose(draft.table.columns) | stated
    if found.keys() >= {"base_position", "base_orientation"}:
        for signal in ("base_position", "base_orientation"):
            because = "you said so" if signal in stated else "its name; the model's base floats"
            draft.assume(signal, ", ".join(found[signal]), 1.0 if signal in stated else 0.95, because)
        return found
    draft.notes.append(
        "The model's base floats, and no columns say where it was: name them, --column base_position=X,Y,Z "
        "--column base_orientation=W,X,Y,Z (m; unit quaternion, in the world)."
    )
    return stated


def _pose(columns: Mapping[str, np.ndarray]) -> dict[str, list[str]]:
    """Place and quaternion, where names end in letters and one quaternion has the length of one."""
    groups: dict[str, dict[str, str]] = {}
    for name in columns:
        end = _ENDS.fullmatch(name.lower())
        if end:
            groups.setdefault(end[1] + end[2], {})[end[3]] = name
    turns = {
        stem: [named[k] for k in "wxyz"]
        for stem, named in groups.items()
        if named.keys() == set("wxyz") and _is_turn([columns[named[k]] for k in "wxyz"])
    }
    if len(turns) != 1:
        return {}
    ((stem, turn),) = turns.items()
    places = {s: [named[k] for k in "xyz"] for s, named in groups.items() if named.keys() == set("xyz")}
    places = {s: names for s, names in places.items() if _is_place(names[0])}
    if not places:
        return {}
    near = {s: _alike(s, stem) for s in places}
    best = [s for s in places if near[s] == max(near.values())]
    return {"base_position": places[best[0]], "base_orientation": turn} if len(best) == 1 else {}


def _is_turn(parts: Sequence[np.ndarray]) -> bool:
    length = np.sqrt(np.sum(np.square(parts), axis=0))
    length = length[np.isfinite(length)]
    return bool(len(length) and np.abs(length - 1.0).max() < _UNIT)


def _is_place(name: str) -> bool:
    role = role_of(name)
    return role.kind not in _RATES and not set(role.words) & _OTHERS and role.role != "reference"


def _alike(one: str, other: str) -> int:
    """How many letters two names begin with together."""
    return next(
        (k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other))
    )


def _letters(signal: str) -> str:
    return "WXYZ" if BASE[signal] == 4 else "XYZ"
