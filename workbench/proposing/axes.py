"""Names and order of the joints, and every signal in this order."""

from __future__ import annotations

import re
from collections.abc import Sequence

from workbench.core import InputError

from .assignment import Signals
from .draft import Draft
from .proposal import Question


def named_axes(signals: Signals, draft: Draft) -> tuple[list[str], dict[str, list[str]]]:
    """Return axis names, and signal -> a column per axis; signals that lack a joint are noted, left out.

    Raises:
        InputError: there is no position, or another number of axes than was stated.
    """
    positions = signals.columns.get("position")
    if not positions:
        shown = ", ".join(list(draft.table.columns)[:12])
        raise InputError(
            "no column looks like a measured position", file=draft.table.file,
            remedy=f"name them: --column position=A,B; the columns are {shown}",
        )  # fmt: skip
    joints, axes = _axes(positions, draft)
    stated = _stated_in_order(draft, joints, axes)
    columns: dict[str, list[str]] = {}
    for signal, found in signals.columns.items():
        by_joint = stated.get(signal, found)
        row = _in_order(by_joint, joints, list(positions))
        if row is None:
            missing = [a for j, a in zip(joints, axes, strict=True) if j not in by_joint]
            lacking = f"There is no {signal} of {', '.join(missing)}; the signal is left out."
            draft.notes.append(lacking)
            continue
        columns[signal] = row
        short = [re.sub(r"^.*/(?=[^\[\](){}]*(\[\d+\])?$)", "", name) for name in row]
        few = len(short) < 3 or len(", ".join(short)) < 30
        shown = ", ".join(short) if few else f"{short[0]} ... {short[-1]}"
        draft.assume(signal, shown, signals.sure.get(signal, 0.97), signals.because.get(signal, "its name"))
    return axes, columns


def _stated_in_order(draft: Draft, joints: list[str], axes: list[str]) -> dict[str, dict[str, str]]:
    """Signal -> joint -> column of signals that are stated alone: one per axis, whatever the file's order is.

    Beside stated positions they stand in the order of these, which their names may change.
    """
    if "position" in draft.answers.columns:
        return {}
    joint_of = dict(zip(axes, joints, strict=True))
    order = [joint_of[axis] for axis in draft.answers.axes or axes]
    said = draft.answers.columns.items()
    return {
        signal: dict(zip(order, names, strict=True)) for signal, names in said if len(names) == len(order)
    }


def _axes(positions: dict[str, str], draft: Draft) -> tuple[list[str], list[str]]:
    """Joints in the order of the axes, and the axes' names; `positions` are joint -> column."""
    joints = list(positions)
    own = [_readable(j, k, len(joints)) for k, j in enumerate(joints)]
    wanted = list(draft.answers.axes or draft.answers.model_axes)
    if not wanted:
        named = not all(not j or j.startswith("column_") for j in joints)
        because = "names of the columns" if named else "numbered in order: the columns have no names"
        draft.assume("axes", ", ".join(own), 0.97 if all(joints) and named else 0.93, because)
        return joints, own
    whole = _verbatim(wanted, positions)
    found = {axis: whole[axis] if axis in whole else _same(axis, joints, own) for axis in wanted}
    matched = [found[a] for a in wanted]
    if all(m is not None for m in matched) and len(set(matched)) == len(matched):
        because = "you said so" if draft.answers.axes else "the model's names"
        draft.assume("axes", ", ".join(wanted), 1.0 if draft.answers.axes else 0.98, because)
        left = [o for j, o in zip(joints, own, strict=True) if j not in matched]
        if left:
            draft.notes.append(f"Not among the axes: {', '.join(left)}.")
        return [m for m in matched if m is not None], wanted
    missing = [axis for axis in wanted if found[axis] is None]
    if len(joints) < len(wanted) and len(missing) == len(wanted) - len(joints):
        names = ",".join("NAME" if (joint := found[a]) is None else positions[joint] for a in wanted)
        raise InputError(
            f"has no position of {', '.join(missing)}", file=draft.table.file,
            remedy=f"log it, or name its column: --column 'position={names}'",
        )  # fmt: skip
    if len(wanted) != len(joints):
        names = ",".join(["NAME"] * len(wanted))
        shown = ", ".join(list(positions.values())[:12])
        raise InputError(
            f"has positions of {len(joints)} joints ({', '.join(own)}) for {len(wanted)} axes",
            file=draft.table.file,
            remedy=f"say which belong to {', '.join(wanted)}, in this order: --column position={names} "
            f"of the columns {shown}",
        )
    if draft.answers.axes or "position" in draft.answers.columns:
        if sorted(wanted) == sorted(draft.answers.model_axes):
            # the names were given in the file's order; a recording's order is its model's
            by_name = dict(zip(wanted, joints, strict=True))
            wanted = list(draft.answers.model_axes)
            joints = [by_name[axis] for axis in wanted]
        draft.assume("axes", ", ".join(wanted), 1.0, "you said so")
    elif len(wanted) == 1:
        draft.assume("axes", wanted[0], 0.98, "the model's only axis")
    else:
        pairs = ", ".join(f"{positions[j]} is {w}" for j, w in zip(joints, wanted, strict=True))
        draft.assume("axes", ", ".join(wanted), 0.85, "the model's order")
        text = f"Names in the file and in the model differ. Is this assignment right: {pairs}?"
        named = ",".join(wanted)
        draft.questions.append(Question("axes", text, (named,), named, f"--axis {' --axis '.join(wanted)}"))
    return joints, wanted


def _verbatim(axes: Sequence[str], positions: dict[str, str]) -> dict[str, str]:
    """Axis -> the one joint in whose column's name the axis' name stands as it is.

    Of names that begin alike the longer one comes first: "motor" stands in the column of "motor_2" too.
    """
    found: dict[str, str] = {}
    for axis in sorted(axes, key=len, reverse=True):
        whole = re.compile(rf"(?<![a-z0-9]){re.escape(axis.lower())}(?![a-z0-9])")
        having = [j for j, c in positions.items() if whole.search(c.lower()) and j not in found.values()]
        if len(having) == 1:
            found[axis] = having[0]
    return found


def _same(axis: str, joints: list[str], own: list[str]) -> str | None:
    """The joint that an axis' name means: the same words, else the one joint that has it in its name."""
    plain = [_plain(o) for o in own]
    if plain.count(_plain(axis)) == 1:
        return joints[plain.index(_plain(axis))]
    near = [j for j, p in zip(joints, plain, strict=True) if p and (p in _plain(axis) or _plain(axis) in p)]
    return near[0] if len(near) == 1 and len(_plain(axis)) > 2 and not near[0].isdigit() else None


def _plain(name: str) -> str:
    words = [w for w in re.findall(r"[a-z]+|[0-9]+", name.lower()) if w not in ("joint", "axis", "motor")]
    return "".join(words)


def _readable(joint: str, k: int, count: int) -> str:
    if not joint or joint.startswith("column_"):
        return "joint" if count == 1 else f"joint{k + 1}"
    return f"joint{joint}" if joint.isdigit() else joint


def _in_order(by_joint: dict[str, str], joints: list[str], every: list[str]) -> list[str] | None:
    """One column per joint: by name, else by order where there are as many as positions."""
    if all(j in by_joint for j in joints):
        return [by_joint[j] for j in joints]
    if len(by_joint) == len(every) and not set(by_joint) & set(every):
        by_place = dict(zip(every, by_joint.values(), strict=True))
        return [by_place[j] for j in joints]
    return None
