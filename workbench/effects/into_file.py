"""Found effects as numbers of the user's own MJCF or URDF, in which everything else stays as it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.core.xml_text import XmlText
from workbench.models import (
    AppliedEffect,
    BodyNumbers,
    Inertial,
    JointNumber,
    MjcfText,
    Model,
    Placement,
    UrdfText,
    check_mjcf,
    differ,
    inertial_frame,
    is_urdf,
    load_tree,
)

from .build import compile_plant
from .catalogue import effect_named
from .file_check import check_inertials, check_same

_ROUNDING = 1e-9  # of what the file has: how far a total may fall short of nothing


@dataclass(frozen=True)
class Change:
    """A number of a file: its old and its new value.

    `joint`: at or behind which joint, or at which tendon; `number`: as MJCF calls it, and ``mass``,
    ``centre`` (3,) or ``inertia`` (3, 3) of the body that it carries, in its own frame. SI, rad.
    """

    joint: str
    number: str
    before: float | np.ndarray
    after: float | np.ndarray


@dataclass(frozen=True)
class InFile:
    """A file with the effects of a model in its numbers.

    `content`: the whole file. `changes`: what is new in it. `written`, `left`: effects that are in it, and
    those that it has no number for.
    """

    content: bytes
    changes: tuple[Change, ...]
    written: tuple[AppliedEffect, ...]
    left: tuple[AppliedEffect, ...]


def into_file(model: Model, file: Path) -> InFile:
    """Write the effects of a model into the numbers of its MJCF or URDF; nothing is written to the disk.

    Args:
        model: with all effects that the file shall have.
        file: the model's `serial`, or one that it includes.

    Raises:
        InputError: `file` is no part of the model, lacks a joint, or gets a number below zero; or the
            machine that MuJoCo makes of it is not the model.
    """
    text = open_text(model, file)
    target = UrdfText(text) if is_urdf(file) else MjcfText(text)
    written: list[tuple[AppliedEffect, JointNumber | BodyNumbers]] = []
    left: list[AppliedEffect] = []
    for applied in model.effects:
        corrects, place = effect_named(applied.key.effect).corrects, Placement.of(model, applied.key)
        number = corrects and place and corrects.in_file(model, place, applied.values)
        if number is None or (isinstance(number, JointNumber) and number.number not in target.numbers):
            left.append(applied)
        else:
            written.append((applied, number))
    for _, number in written:
        _check_there(model, target, number, file)
    held = replace(model, effects=tuple(applied for applied, _ in written))
    changes = _joints(model, target, [n for _, n in written if isinstance(n, JointNumber)], file)
    changes += _bodies(held, target, [n for _, n in written if isinstance(n, BodyNumbers)])
    out = InFile(text.result(), tuple(changes), held.effects, tuple(left))
    if written:
        check_same(held, file, out.content)
    return out


def inertials_into_file(model: Model, file: Path, inertials: Mapping[str, Inertial]) -> InFile:
    """Write the inertials of links into the model's MJCF or URDF; nothing is written to the disk.

    Args:
        model: whose file it is.
        file: the model's `serial`, or one that it includes.
        inertials: of the bodies that joints carry, by joint.

    Raises:
        InputError: `file` is no part of the model, lacks a joint, or MuJoCo takes other numbers from it.
    """
    text = open_text(model, file)
    target = UrdfText(text) if is_urdf(file) else MjcfText(text)
    for joint in inertials:
        _check_there(model, target, BodyNumbers(joint), file)
    changes = _set_bodies(model, target, inertials)
    out = InFile(text.result(), tuple(changes), (), ())
    check_inertials(model, file, out.content, inertials)
    return out


def open_text(model: Model, file: Path) -> XmlText:
    """Return the text of the file that a model is based on.

    Raises:
        InputError: it is none of the model's, or cannot be read.
    """
    own = [model.serial] if is_urdf(model.serial) else check_mjcf(model.serial)
    if file.resolve() not in {each.resolve() for each in own}:
        raise InputError(
            f"model '{model.name}' is not based on this file",
            file=file,
            remedy=f"it is based on {model.serial}",
        )
    return XmlText(file.read_bytes(), file)


def _check_there(
    model: Model, target: MjcfText | UrdfText, number: JointNumber | BodyNumbers, file: Path
) -> None:
    if not target.has(number.joint, _kind(number)):
        problem = f"{_kind(number)} '{number.joint}' is not in it"
        raise InputError(problem, file=file, remedy=_where(model, number))


def _kind(number: JointNumber | BodyNumbers) -> str:
    return number.element if isinstance(number, JointNumber) else "joint"


def _where(model: Model, number: JointNumber | BodyNumbers) -> str:
    """Return the file of the model that has the joint."""
    for each in check_mjcf(model.serial):
        if each.suffix.lower() == ".xml" and MjcfText(XmlText(each.read_bytes(), each)).has(
            number.joint, _kind(number)
        ):
            return f"it is in {each}: give that file"
    return "it is made from another one there, by <attach> or <replicate>: write the model as .toml"


def _joints(
    model: Model, target: MjcfText | UrdfText, numbers: Sequence[JointNumber], file: Path
) -> list[Change]:
    """Return totals at the joints: the file's numbers plus all changes."""
    spec = load_tree(model.serial)
    m, changes = spec.compile(), list[Change]()
    totals: dict[tuple[str, str], dict[str, float]] = {}
    for name, kind, number in dict.fromkeys((n.joint, n.element, n.number) for n in numbers):
        more = [n for n in numbers if (n.joint, n.element, n.number) == (name, kind, number)]
        before = _stated(m, name, kind, number)
        after = before + sum(n.more for n in more)
        if after < -_ROUNDING * max(abs(before), *(abs(n.more) for n in more)):
            raise InputError(
                f"{kind} '{name}' would have {number} {after:.3g}", file=file, column=number,
                remedy=f"the file has {before:.3g}; the rest comes from {model.source or 'the model'}",
            )  # fmt: skip
        after = max(after, 0.0)
        values = totals.setdefault((name, kind), {})
        values[number] = after
        changes.append(Change(name, number, before, after))
        if number == "stiffness" and after > 0.0:
            was = _stated(m, name, kind, "springref")
            rest = (before * was + sum(n.more * n.rest for n in more)) / after
            degrees = spec.compiler.degree and m.joint(name).type[0] == mujoco.mjtJoint.mjJNT_HINGE
            values["springref"] = np.degrees(rest) if degrees else rest
            changes.append(Change(name, "springref", was, rest))
    for (name, kind), values in totals.items():
        target.set_numbers(name, values, kind)
    return changes


def _stated(m: mujoco.MjModel, name: str, kind: str, number: str) -> float:
    """Return the file's value of a number of a joint or tendon."""
    if kind == "tendon":
        return float(getattr(m, f"tendon_{number}")[m.tendon(name).id])
    own, dof = m.joint(name), int(m.joint(name).dofadr[0])
    if number == "stiffness":
        return float(m.jnt_stiffness[own.id])
    if number == "springref":
        return float(m.qpos_spring[int(own.qposadr[0])])
    return float(getattr(m, f"dof_{number}")[dof])


def _bodies(held: Model, target: MjcfText | UrdfText, numbers: Sequence[BodyNumbers]) -> list[Change]:
    """Return inertials of bodies of the model with its effects."""
    if not numbers:
        return []
    made = compile_plant(held).mujoco
    joints = dict.fromkeys(n.joint for n in numbers)
    return _set_bodies(held, target, {j: Inertial.of(made, int(made.joint(j).bodyid[0])) for j in joints})


def _set_bodies(model: Model, target: MjcfText | UrdfText, inertials: Mapping[str, Inertial]) -> list[Change]:
    """Give the bodies that joints carry other inertials."""
    m, changes = load_tree(model.serial).compile(), []
    for joint, after in inertials.items():
        body = int(m.joint(joint).bodyid[0])
        before = Inertial.of(m, body)
        target.set_body(joint, before, after, inertial_frame(m, body))
        pairs = (("mass", "mass"), ("centre", "centre"), ("inertia", "tensor"))
        changes += [
            Change(joint, name, getattr(before, a), getattr(after, a))
            for name, a in pairs
            if differ(getattr(before, a), getattr(after, a))
        ]
    return changes
