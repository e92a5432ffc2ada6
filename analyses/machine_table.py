"""What was said of a measured machine beside what is right: causes that are named, missed or false.

The right is `real_machines.toml`; answers are those of `machine_run.py`.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

TABLE = Path(__file__).with_name("real_machines.toml")
Machine = Mapping[str, Any]
Answer = Mapping[str, Any]
State = Literal["named", "outside", "not named", "read", "false"]
_SAME = 0.02  # two orders of a ripple closer than this are one


@dataclass(frozen=True)
class Row:
    """One cause or number: what is known of it and what was said.

    Attributes:
        what: effect, or name of a number that is read off.
        axis: where; None where it acts on all axes.
        parameter: which number of it, and of which of several on one axis.
        known: its published value, None where only the cause is known.
        found: value, deviation and unit that were found; None where it is not named.
        state: ``named`` (within its bounds, or without any), ``read`` (the same of a number read off),
            ``outside``, ``not named``, ``false`` (named, but not known to be there).
    """

    what: str
    axis: str | None
    parameter: str
    known: float | None
    found: Mapping[str, Any] | None
    state: State


def machines() -> list[Machine]:
    """All machines with what is right for them."""
    return tomllib.loads(TABLE.read_text(encoding="utf-8"))["machine"]


def named(answer: Answer) -> Sequence[Mapping[str, Any]]:
    """The causes that an answer names; what only comes nearest is none."""
    return answer.get("findings", ())


def rows(machine: Machine, answer: Answer) -> list[Row]:
    """Each right cause and number with what was said of it; then what was named beside them."""
    steps = named(answer)
    out = [_right(right, steps) for right in machine.get("right", ())]
    for r in machine.get("read", ()):
        found = answer.get("read", {}).get(r["name"])
        state: State = "not named" if found is None else "read" if _within(r, found) else "outside"
        out.append(Row(r["name"], None, "", r["value"], found, state))
    if "right" in machine or machine.get("verdict") == "consistent":
        allowed = {f"{r['effect']}@{r['axis']}" for r in machine.get("right", ())}
        allowed |= set(machine.get("also", ()))
        for s in steps:
            if f"{s['effect']}@{s['axis']}" not in allowed:
                parameter, found = next(iter(s["parameters"].items()))
                out.append(Row(s["effect"], s["axis"], parameter, None, found, "false"))
    return out


def counts(found: Sequence[Row]) -> dict[str, int]:
    """How many causes are named (bounds or not), values outside their bounds, and false names there are."""
    of = [r.state for r in found]
    named_too = sum(r.state == "outside" and r.parameter != "" for r in found)
    return {
        "named": of.count("named") + named_too,
        "outside": of.count("outside"),
        "false": of.count("false"),
    }


def ratio(answer: Answer, when: Literal["before", "after"]) -> float:
    """Error over noise on data that were not fitted; after: with what is named, as given if nothing is.

    Both over the floor of the better model, which is nearer to what a perfect one leaves: with a rotor that
    is too heavy, noise of the encoder is large torques.
    """
    if "judged" not in answer:
        return math.nan
    end = "after" if named(answer) else "before"
    errors = answer["judged"]
    return (errors["before"] if when == "before" else errors[end])["error"] / errors[end]["noise"]


def _right(right: Mapping[str, Any], steps: Sequence[Mapping[str, Any]]) -> Row:
    what, axis, parameter = right["effect"], right.get("axis"), right["parameter"]
    shown = parameter + "".join(f" ({k} {v:g})" for k, v in right.get("when", {}).items())
    for s in steps:
        if s["effect"] == what and s["axis"] == axis and _meets(right.get("when", {}), s["parameters"]):
            found = s["parameters"][parameter]
            good = "value" not in right or _within(right, found)
            return Row(what, axis, shown, right.get("value"), found, "named" if good else "outside")
    return Row(what, axis, shown, right.get("value"), None, "not named")


def _meets(when: Mapping[str, float], parameters: Mapping[str, Any]) -> bool:
    return all(abs(parameters[k]["value"] - v) <= _SAME * v for k, v in when.items())


def _within(right: Mapping[str, Any], found: Mapping[str, Any]) -> bool:
    return abs(found["value"] - right["value"]) <= right["within"] * abs(right["value"])
