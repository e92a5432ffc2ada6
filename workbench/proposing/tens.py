"""Factors of ten: velocity, position or clock is wrong, and only other information shows which."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .draft import Draft
from .proposal import Question


def ask_tens(draft: Draft, units: Mapping[str, Sequence[str]], *, timed: bool) -> None:
    """Ask if a velocity is ten, a hundred ... times what it should be.

    Args:
        draft: takes the question.
        units: kind -> unit of each axis.
        timed: whether there is a column of time.
    """
    if {"velocity", "position", "unit"} & draft.answers.units.keys() or "time" in draft.answers.units:
        return
    off = [i for i, unit in enumerate(units["velocity"]) if unit[0].isdigit() and not unit.endswith("turn/s")]
    if not off:
        return
    size = float(units["velocity"][off[0]].partition("*")[0])
    position = [f"{1 / size:g}*{u}" if i in off else u for i, u in enumerate(units["position"])]
    ways = [f"velocity={_one(units['velocity'])}", f"position={_one(position)}"]
    if timed and len(off) == len(units["velocity"]):
        ways.append(f"time={size:g}*{units['time'][0]}")
    text = (
        f"Velocity is {1 / size:g} times the derivative of position. Which of them is off by that factor: "
        f"{' or '.join(ways)}?"
    )
    draft.questions.append(Question("unit", text, tuple(ways), ways[0], f"--unit {ways[0]}"))


def _one(units: Sequence[str]) -> str:
    return units[0] if len(set(units)) == 1 else ",".join(units)
