"""From the columns of a file to the description of a recording, with assumptions and questions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from workbench.core import AXIS_SIGNALS, InputError

from .assignment import Signals
from .axes import named_axes
from .base import BASE, base_columns
from .clean import Clean
from .clock import find_time, rate_question
from .column_context import with_kinds
from .copies import each_row_once
from .draft import Draft
from .gains import GAINS, gains_shown, take_controller
from .like_quantities import joints_like_quantities
from .merge import on_rows_of
from .names import Role, name_joints, role_of
from .proposal import Answers, Proposal, Question, listed
from .resolve_units import resolve_units
from .rows import on_rows_of_axes
from .scaling import resolve_scales
from .signals import read_signals
from .signed import signed_counts
from .stamps import whole_clocks
from .stated import EXAMPLES
from .table import Table
from .units import pint_unit
from .unused import note_unused
from .usable import usable_rows, valid_column
from .velocities import derivatives, uncross
from .wraps import whole_positions

#: Kinds whose unit can be stated, and an example of each.
UNITS = {"time": "ms", **{kind: turning for kind, (turning, _) in EXAMPLES.items()}}
UNITS |= {"current": "A", "voltage": "V", "temperature": "degC"}


def propose(table: Table, answers: Answers | None = None) -> Proposal:
    """Return the proposal for a table.

    Args:
        table: the columns.
        answers: what the user says already.

    Returns:
        A description with the likeliest reading; nothing that is a question has been settled in silence.

    Raises:
        InputError: no position is among the columns, or an answer names what is not there.
    """
    answers = answers or Answers()
    _check_answers(table, answers)
    table = signed_counts(on_rows_of(table, answers))
    if "time" not in answers.columns:
        table = whole_clocks(table)
    roles = _roles(table)
    time = find_time(table, roles, answers)[0]
    if time is not None:
        table = each_row_once(on_rows_of_axes(table, roles, time, answers), roles, answers)
    return _drafted(Draft(table, answers, roles, notes=list(table.notes)))


def _roles(table: Table) -> dict[str, Role]:
    names = list(table.columns)
    like = joints_like_quantities(names)
    named = name_joints(with_kinds([like.get(n) or role_of(n, table.units.get(n, "")) for n in names]))
    roles = dict(zip(names, named, strict=True))
    return roles | {n: replace(roles[n], joint=joint) for n, joint in table.joints.items() if n in roles}


def _check_answers(table: Table, answers: Answers) -> None:
    for signal, names in answers.columns.items():
        if signal not in (*AXIS_SIGNALS, *BASE, "time", "valid"):
            known = ", ".join(("time", *AXIS_SIGNALS, *BASE))
            raise InputError(f"there is no signal '{signal}'", file=table.file, remedy=f"one of {known}")
        for name in names:
            if name not in table.columns:
                more = len(table.columns) - 20
                shown = ", ".join(list(table.columns)[:20]) + (f" and {more} more" if more > 0 else "")
                raise InputError(
                    "there is no such column", file=table.file, column=name, remedy=f"it has: {shown}"
                )
    for kind, text in answers.units.items():
        wrong = [unit for unit in listed(text) or ("",) if not pint_unit(unit, kind)]
        if kind not in UNITS or (kind == "time" and len(listed(text)) > 1) or wrong:
            known = f"choose one of {', '.join(UNITS)}"
            remedy = f"e.g. --unit {kind}={UNITS[kind]}" if kind in UNITS else known
            if kind == "torque" and wrong and pint_unit(wrong[0], "current"):
                remedy = "give the torque constants, in N m per A: --unit torque=0.5*N*m, or one per axis"
            raise InputError(
                f"'{wrong[0] if wrong else text}' is not a unit of {kind}", file=table.file, remedy=remedy
            )


def _drafted(draft: Draft) -> Proposal:
    table = draft.table
    time = _time(draft)
    base = base_columns(draft)
    of_base = {name for names in base.values() for name in names}
    of_axes = {name: values for name, values in table.columns.items() if name not in of_base}
    signals = read_signals(replace(table, columns=of_axes), draft.roles, time)
    draft.notes += signals.notes
    _take_stated(draft, signals)
    axes, columns = named_axes(signals, draft)
    rows = usable_rows(draft, time, columns | base)
    period_raw = float(np.median(np.diff(rows.columns[time or "t"])))
    controller = take_controller(draft, columns, axes, _coordinates(draft.answers))
    whole, wraps = whole_positions(rows, columns["position"])
    columns = uncross(draft, whole, columns, axes)
    relations = derivatives(whole, columns)
    units = resolve_units(draft, whole, columns, axes, time, period_raw, relations, wraps)
    scales = resolve_scales(draft, columns, axes, units, relations)
    description = _description(draft, axes, columns, units, scales, rows, time)
    description["columns"] |= base
    if controller:
        description["controller"] = controller
        draft.assume("controller", gains_shown(controller), 0.97, "gains are logged beside the references")
    named = (
        of_base
        | {n for names in columns.values() for n in names}
        | {n for n in table.columns if _is_loop(draft, n)}
    )
    unused = [n for n in table.columns if n not in named and n not in (time, valid_column(draft))]
    note_unused(draft, unused, columns, len(axes))
    rewritten = not table.plain or rows.changed or time is None
    data = dict(rows.columns) if rewritten else None
    if data is not None:
        if rows.valid is not None:
            data["valid"] = rows.valid.astype(float)
        data, description["columns"] = _writable(data, description["columns"])
    return Proposal(description, data, tuple(draft.assumed), tuple(draft.questions), tuple(draft.notes))


def _time(draft: Draft) -> str | None:
    time, because, sure = find_time(draft.table, draft.roles, draft.answers)
    if time is not None:
        draft.assume("time", time, sure, because)
    elif draft.answers.rate_hz is None:
        draft.questions.append(rate_question())
    else:
        guessed = "rate" in draft.answers.guessed
        because = "velocity over slope of position" if guessed else "you said so"
        draft.assume("time", f"{draft.answers.rate_hz:g} rows per second", 0.8 if guessed else 1.0, because)
    return time


def _take_stated(draft: Draft, signals: Signals) -> None:
    for signal, names in draft.answers.columns.items():
        if signal in AXIS_SIGNALS:
            before = signals.columns.get("position", {})
            known = {column: joint for joint, column in before.items()}
            joints = [known.get(n) or draft.roles[n].joint or n for n in names]
            if len(before) == len(names) and not (signal == "position" and set(names) <= known.keys()):
                joints = list(before)
            for other in signals.columns.values():
                for joint in [j for j, c in other.items() if c in names]:
                    del other[joint]
            signals.columns[signal] = dict(zip(joints, names, strict=True))
            signals.sure[signal], signals.because[signal] = 1.0, "you said so"
    signals.columns = {s: c for s, c in signals.columns.items() if c}


def _description(
    draft: Draft,
    axes: Sequence[str],
    columns: dict[str, list[str]],
    units: dict[str, tuple[str, ...]],
    scales: dict[str, list[float]],
    rows: Clean,
    time: str | None,
) -> dict[str, Any]:
    out: dict[str, Any] = {"time": time or "t"}
    for signal in AXIS_SIGNALS:
        if signal in columns:
            factors = scales.get(signal, [1.0] * len(axes))
            out[signal] = [
                name if f == 1.0 else {"column": name, "scale": f}
                for name, f in zip(columns[signal], factors, strict=True)
            ]
    if rows.valid is not None:
        out["valid"] = "valid"
    coordinates = _coordinates(draft.answers)
    if draft.answers.transmission is not None and not draft.answers.coordinates:
        text = (
            "The model's drives and joints turn differently. Were the signals measured at the drives or at "
            "the joints?"
        )
        options = ("actuator", "joint")
        draft.questions.append(Question("coordinates", text, options, "actuator", "--coordinates actuator"))
        draft.assume("coordinates", "actuator", 0.7, "encoders usually sit at the drives")
    return {
        "format": 1,
        "rig": "",
        "coordinates": coordinates,
        "axes": list(axes),
        "columns": out,
        "units": {kind: each[0] if len(set(each)) == 1 else list(each) for kind, each in units.items()},
        **({"guessed_units": guessed} if (guessed := _guessed(draft)) else {}),
    }


def _guessed(draft: Draft) -> list[str]:
    """Kinds of units that nothing but the size of numbers tells: a diagnosis doubts these first."""
    told = {
        a.what.removeprefix("unit of "): a.because for a in draft.assumed if a.what.startswith("unit of ")
    }
    guessed = [kind for kind in EXAMPLES if told.get(kind, "").startswith("numbers")]
    # what one of the two is, the slope tells of the other
    motion = {"position", "velocity"} & told.keys()
    return [kind for kind in guessed if kind == "torque" or motion <= set(guessed)]


def _coordinates(answers: Answers) -> str:
    return answers.coordinates or ("joint" if answers.transmission is None else "actuator")


def _is_loop(draft: Draft, column: str) -> bool:
    """Whether a column is a part of a loop that needs no signal: a gain, or a reference that stays nil."""
    role = draft.roles[column]
    nil = role.role in ("reference", "feedforward") and not np.nan_to_num(draft.table.columns[column]).any()
    return role.kind in GAINS or (nil and role.kind in ("velocity", "torque"))


def _writable(
    data: dict[str, np.ndarray], columns: dict[str, Any]
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Names without the marks that separate cells, in the data and where they are named."""
    new = {name: " ".join(re.sub(r'[,;"\t\r\n]', " ", name).split()) for name in data}
    if len(set(new.values())) < len(new):
        new = {name: f"column_{k}" for k, name in enumerate(data)}

    def renamed(value: Any) -> Any:
        if isinstance(value, list):
            return [renamed(v) for v in value]
        if isinstance(value, dict):
            return {**value, "column": new[value["column"]]}
        return new[value]

    return {new[n]: v for n, v in data.items()}, {signal: renamed(value) for signal, value in columns.items()}
