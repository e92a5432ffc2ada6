"""Units and signs: what is sure is noted as an assumption, what is not becomes a question."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError

from .clean import Clean
from .clock import time_weights
from .draft import FALLBACK_RATE, Draft
from .match import Relation
from .proposal import ASK, Question
from .scales import Told, weigh
from .units import by_size, is_linear, pint_unit, scale

_POSITION_KINDS = ("position", "position_reference", "link_position")


def settle_units(
    draft: Draft,
    rows: Clean,
    columns: dict[str, list[str]],
    time: str | None,
    step: float,
    relations: list[Relation],
) -> dict[str, str]:
    """Kind -> unit of the columns, by their names, their sizes, and velocity against position.

    Args:
        draft: takes what is assumed, asked and noted.
        rows: of the columns that are used.
        columns: signal -> its columns, one an axis.
        time: the column of time, if there is one.
        step: median step of time [its unit].
        relations: of velocity to position, one an axis.

    Raises:
        InputError: no unit makes such numbers likely.
    """
    by_time: dict[str, float] = {"s": 1.0}
    why_time = "you said so"
    if time is not None:
        by_time, why_time = time_weights(draft.table.columns[time], draft.roles[time], draft.answers)
    by_position, why_position = _weights(draft, "position", rows, columns["position"])
    by_velocity, why_velocity = {}, ""
    if "velocity" in columns:
        by_velocity, why_velocity = _weights(draft, "velocity", rows, columns["velocity"])
    good = [r for r in relations if r.likeness > 0.9]
    # per row to per unit of time
    factor = float(np.median([abs(r.factor) for r in good])) * step if good else None
    told = weigh(by_time, by_position, by_velocity, factor)
    for kind in ("time", "position"):
        if kind not in told:  # no unit makes such numbers likely
            raise InputError(
                f"the unit of {kind} cannot be told from such numbers", file=draft.table.file,
                remedy=f"say it: --unit {kind}=UNIT",
            )  # fmt: skip
    if factor and "velocity" in told and told["position"].unit != "counts":
        expected = scale(told["position"].unit, "position") / (
            scale(told["time"].unit, "time") * scale(told["velocity"].unit, "velocity")
        )
        if abs(factor / expected - 1) < 0.1:
            tie = "velocity over slope of position"
            why_position, why_velocity = _and(why_position, tie), _and(why_velocity, tie)
            why_time = _and(why_time, tie)
        elif time is None and draft.answers.rate_hz is None:
            _ask_rate(draft, expected / factor)
        else:
            ratio = factor / expected
            draft.notes.append(
                f"Velocity is {ratio:.4g} times the derivative of position in these units: "
                "a gear ratio, or a wrong unit?"
            )
    units = {}
    if time is not None:
        units["time"] = _settle(draft, "time", told["time"], why_time)
    units["position"] = _settle(draft, "position", told["position"], why_position)
    if "velocity" in told:
        units["velocity"] = _settle(draft, "velocity", told["velocity"], why_velocity)
    torques = [n for s, names in columns.items() if s.startswith("torque") for n in names]
    if torques:
        weights, why = _weights(
            draft, "torque", rows, torques, linear=is_linear(_or_rad(units["position"]), "position")
        )
        best = max(weights, key=lambda u: weights[u])
        units["torque"] = _settle(draft, "torque", Told(best, weights[best] / sum(weights.values())), why)
    for kind in ("current", "voltage", "temperature"):
        if kind in columns:
            hint = pint_unit(draft.roles[columns[kind][0]].unit, kind)
            units[kind] = hint or {"current": "A", "voltage": "V", "temperature": "degC"}[kind]
    return units


def _weights(
    draft: Draft, kind: str, rows: Clean, names: list[str], linear: bool | None = None
) -> tuple[dict[str, float], str]:
    stated = draft.answers.units.get(kind)
    if stated:
        return {pint_unit(stated, kind): 1.0}, "you said so"
    if kind == "position" and draft.answers.counts:
        return {"turn": 1.0}, "you said so"
    hints = {pint_unit(draft.roles[n].unit, kind) for n in names if draft.roles[n].unit} - {""}
    by = by_size(kind, np.column_stack([rows.columns[n] for n in names]))
    if linear is None:
        linear = bool(draft.answers.linear) and all(draft.answers.linear)
    if linear:
        by = {
            "position": {"m": 1.0, "mm": 0.03},
            "velocity": {"m/s": 1.0, "mm/s": 0.03},
            "torque": {"N": 1.0},
        }[kind]
    by = {u: w for u, w in by.items() if w > 0}
    if len(hints) == 1:
        hint = hints.pop()
        return {**{u: 1e-4 * w for u, w in by.items()}, hint: 1.0}, "its name says so"
    top = float(np.nanmax(np.abs(np.column_stack([rows.columns[n] for n in names]))))
    return by, f"numbers up to {top:.3g}"


def _settle(draft: Draft, kind: str, told: Told, because: str) -> str:
    """Note a unit; where it is not sure, ask."""
    name = f"unit of {kind}"
    if kind in draft.answers.units:
        draft.assume(name, told.unit, 1.0, "you said so")
        return told.unit
    if told.unit == "counts":
        text = "Positions are whole numbers, encoder counts it seems. How many make a turn?"
        draft.questions.append(Question("counts", text, (), "", "--counts N (or --unit position=UNIT)"))
        return "turn"
    draft.assume(name, told.unit, told.sure, because)
    if told.sure < ASK:
        choices = {
            "time": ("s", "ms", "us", "ns"),
            "position": ("rad", "deg"),
            "velocity": ("rad/s", "deg/s", "rpm"),
        }
        options = choices.get(kind, ("N*m", "mN*m", "N*mm"))
        text = f"What is the unit of {kind}: {' or '.join(options)} ({because})?"
        draft.questions.append(
            Question(f"unit.{kind}", text, options, told.unit, f"--unit {kind}={told.unit}")
        )
    return told.unit


def _ask_rate(draft: Draft, period: float) -> None:
    """The rate that makes velocity the derivative of position, offered as an answer."""
    rate = FALLBACK_RATE / period if period > 0 else 0.0
    draft.questions = [q for q in draft.questions if q.key != "rate"]
    text = f"No column is time; velocity against position says {rate:.4g} rows a second. Is that so?"
    draft.questions.append(Question("rate", text, (), f"{rate:.4g}", f"--rate {rate:.4g}"))


def settle_signs(
    draft: Draft,
    columns: dict[str, list[str]],
    axes: Sequence[str],
    relations: list[Relation],
) -> dict[str, list[float]]:
    """Factors on columns: velocities counted the other way, counts per turn."""
    scales: dict[str, list[float]] = {}
    if draft.answers.counts:
        scales = {s: [1.0 / draft.answers.counts] * len(axes) for s in _POSITION_KINDS if s in columns}
    backward = [i for i, r in enumerate(relations) if r.likeness > 0.9 and r.factor < 0]
    if backward:
        scales["velocity"] = [-1.0 if i in backward else 1.0 for i in range(len(axes))]
        which = ", ".join(axes[i] for i in backward)
        draft.assume("sign of velocity", f"reversed: {which}", 0.95, "it falls where position rises")
        draft.notes.append(
            f"Velocity of {which} has the sign against position; it is turned. Is the encoder?"
        )
    return scales


def _and(first: str, second: str) -> str:
    return second if first.startswith("numbers") or first == "rows a second" else f"{first}; {second}"


def _or_rad(unit: str) -> str:
    return unit or "rad"
