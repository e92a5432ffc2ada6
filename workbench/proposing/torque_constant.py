"""Currents instead of torques: they need the torque constant of each drive, which no log contains."""

from __future__ import annotations

from .draft import Draft
from .proposal import UNKNOWN, Question
from .stated import signals_of
from .units import pint_unit


def ask_constant(draft: Draft, columns: dict[str, list[str]]) -> None:
    """Ask for the torque constants if torque columns are currents by their names or units."""
    if "torque" in draft.answers.units:
        return
    named = {name for signal in signals_of("torque", columns) for name in columns[signal]}
    amperes = [n for n in named if draft.roles[n].kind == "current" or _is_current(draft.roles[n].unit)]
    if not amperes:
        return
    n = len(next(iter(columns.values())))
    example = ",".join(["K*N*m"] * n)
    text = (
        f"{', '.join(sorted(amperes))} are currents, by their names. What is the torque constant of "
        "each drive, at the gear's output [N m per A]?"
    )
    draft.unsure("unit of torque", 0.0, UNKNOWN)
    draft.questions = [q for q in draft.questions if q.key != "unit.torque"]
    draft.questions.append(Question("constant", text, (), "", f"--unit torque={example}"))


def _is_current(unit: str) -> bool:
    return bool(unit) and bool(pint_unit(unit, "current"))
