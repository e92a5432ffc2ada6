"""Stated units, axis by axis: by the user, the header, or the joints of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core import AXIS_SIGNALS, InputError

from .draft import Draft
from .proposal import Answers, listed
from .units import has_factor, is_linear, pint_unit, scale, times

#: Quantities whose unit depends on how an axis moves, and an example of each: turning, along a line.
EXAMPLES = {"position": ("deg", "mm"), "velocity": ("deg/s", "mm/s"), "torque": ("N*m", "N")}


@dataclass(frozen=True)
class Stated:
    """Units that are known before the numbers are used; one entry per axis.

    Attributes:
        linear: whether the axis moves along a line.
        modelled: whether only the model says so.
        guessed: whether nobody does, so that it is taken to turn.
        units: kind -> units, ``""`` where nobody states one.
        because: kind -> where the unit is from.
    """

    linear: tuple[bool, ...]
    modelled: tuple[bool, ...]
    guessed: tuple[bool, ...]
    units: dict[str, tuple[str, ...]]
    because: dict[str, tuple[str, ...]]


def signals_of(kind: str, columns: dict[str, list[str]]) -> list[str]:
    """Return the existing signals of a kind, measured motion first."""
    return [s for s, k in AXIS_SIGNALS.items() if k == kind and s in columns]


def header_unit(draft: Draft, column: str, kind: str) -> str:
    """Return the unit in the name of a column; ``""`` if there is none of this kind."""
    unit = draft.roles[column].unit
    return pint_unit(unit, kind) if unit else ""


def stated_units(draft: Draft, columns: dict[str, list[str]], axes: Sequence[str]) -> Stated:
    """Return units by the user's answers, else each axis's header, else headers of similar axes.

    Raises:
        InputError: another number of units than axes, or one unit for axes of which it can be no unit.
    """
    n = len(axes)
    said = {kind: _said(draft, kind, n) for kind in EXAMPLES}
    said["torque"] = of_currents(draft, columns, said["torque"])
    headers = {kind: [_header(draft, columns, kind, i) for i in range(n)] for kind in EXAMPLES}
    modelled = _by_model(draft.answers, axes)
    each = {kind: units if len(units) == n else [""] * n for kind, units in said.items()}
    known = [_first(_moves(each, i), _moves(headers, i)) for i in range(n)]
    _check_model(draft, axes, known, modelled)
    found = [_first(k, m) for k, m in zip(known, modelled, strict=True)]
    one = {kind: units * n for kind, units in said.items() if len(units) == 1}
    rest = {f for f in found if f is not None}
    alike = rest.pop() if len(rest) == 1 else None
    told = [_first(f, _moves(one, i), alike) for i, f in enumerate(found)]
    linear, guessed = tuple(map(bool, told)), tuple(line is None for line in told)
    from_model = tuple(k is None and m is not None for k, m in zip(known, modelled, strict=True))
    for kind, same in one.items():
        _check_one(draft, kind, same[0], axes, linear)
    units: dict[str, tuple[str, ...]] = {}
    because: dict[str, tuple[str, ...]] = {}
    for kind in EXAMPLES:
        each_told = [_unit(draft, kind, i, said[kind], headers[kind], linear) for i in range(n)]
        units[kind] = tuple(unit for unit, _ in each_told)
        because[kind] = tuple(why for _, why in each_told)
    return Stated(linear, from_model, guessed, units, because)


def of_currents(draft: Draft, columns: dict[str, list[str]], said: list[str]) -> list[str]:
    """Return torque units of current columns: constants are N m per A, whatever the unit of the column."""
    signal = next(iter(signals_of("torque", columns)), "")
    out = list(said) * (len(columns[signal]) if signal and len(said) == 1 else 1)
    for i, unit in enumerate(out if signal else ()):
        current = header_unit(draft, columns[signal][i], "current")
        if current and scale(current, "current") != 1.0 and has_factor(unit):
            out[i] = times(scale(current, "current"), unit)
            name = columns[signal][i]
            draft.notes.append(f"'{name}' is in {current}: {unit} per A is {out[i]} per {current}.")
    return out


def _unit(
    draft: Draft, kind: str, i: int, said: list[str], headers: list[str], linear: Sequence[bool]
) -> tuple[str, str]:
    if said:
        return said[i if len(said) > 1 else 0], draft.answers.because(kind)
    if kind == "position" and draft.answers.counts and not linear[i]:
        return "turn", "you said so"
    if headers[i]:
        return headers[i], "its name says so"
    others = {u for u, line in zip(headers, linear, strict=True) if u and line == linear[i]}
    return (others.pop(), "as other axes' names say") if len(others) == 1 else ("", "")


def _said(draft: Draft, kind: str, n: int) -> list[str]:
    """What the user says: nothing, one unit, or one per axis."""
    units = [pint_unit(u, kind) for u in listed(draft.answers.units.get(kind, ""))]
    if len(units) not in (0, 1, n):
        turning, line = EXAMPLES[kind]
        example = ",".join([turning] * (n - 1) + [line])
        raise InputError(
            f"{len(units)} units of {kind} for {n} axes", file=draft.table.file,
            remedy=f"give one, or one per axis: --unit {kind}={example}",
        )  # fmt: skip
    return units


def _check_model(
    draft: Draft, axes: Sequence[str], known: Sequence[bool | None], modelled: Sequence[bool | None]
) -> None:
    """Say where a stated unit is none of the model's joint; it is kept."""
    for axis, stated, joint in zip(axes, known, modelled, strict=True):
        if None not in (stated, joint) and stated != joint:
            is_, but = ("a length", "a hinge") if stated else ("an angle", "a slide")
            draft.notes.append(
                f"'{axis}' is {is_} by its unit, but {but} in the model: is it the right model, "
                "and are the axes in its order?"
            )


def _check_one(draft: Draft, kind: str, unit: str, axes: Sequence[str], linear: Sequence[bool]) -> None:
    """One unit for all axes has to be a unit of each."""
    wrong = [a for a, line in zip(axes, linear, strict=True) if line != is_linear(unit, kind)]
    if not wrong:
        return
    right = [unit if line == is_linear(unit, kind) else EXAMPLES[kind][line] for line in linear]
    moves = "turns" if is_linear(unit, kind) else "moves along a line"
    raise InputError(
        f"'{unit}' is not a unit of {kind} of '{wrong[0]}', which {moves}", file=draft.table.file,
        remedy=f"give one per axis: --unit {kind}={','.join(right)}",
    )  # fmt: skip


def _header(draft: Draft, columns: dict[str, list[str]], kind: str, i: int) -> str:
    units = [header_unit(draft, columns[s][i], kind) for s in signals_of(kind, columns)]
    return next((u for u in units if u), "")


def _first(*options: bool | None) -> bool | None:
    return next((o for o in options if o is not None), None)


def _moves(units: dict[str, list[str]], i: int) -> bool | None:
    """Whether an axis' units are those of a line; None where there are none."""
    return next((is_linear(u[i], kind) for kind, u in units.items() if u[i]), None)


def _by_model(answers: Answers, axes: Sequence[str]) -> list[bool | None]:
    known = dict(zip(answers.model_axes, answers.linear, strict=False))
    if axes and all(a in known for a in axes):
        return [known[a] for a in axes]
    return list(answers.linear) if len(answers.linear) == len(axes) else [None] * len(axes)
