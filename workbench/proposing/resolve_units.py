"""Units: certain ones become assumptions, others become questions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from .clean import Clean
from .clock import time_weights
from .counts import turn_of, turn_that_wraps
from .draft import FALLBACK_RATE, Draft
from .likely import UnitTold, motion_units, torque_units
from .match import Relation
from .normalised import ask_range
from .proposal import ASK, UNKNOWN, Question
from .scales import expected
from .stated import header_unit, signals_of, stated_units
from .unit_conflicts import is_near, note_clock, note_factors, note_rate, note_size
from .units import COUNTS_A_SECOND, pint_unit

_CHOICES = {
    "time": (("s", "ms", "us", "ns"), ()),
    "position": (("rad", "deg", "turn"), ("m", "mm")),
    "velocity": (("rad/s", "deg/s", "rpm", "turn/s"), ("m/s", "mm/s")),
    "torque": (("N*m", "mN*m", "N*mm", "cN*m"), ("N",)),
}
_GUESSED = 0.8
_TURNS = 0.9  # of joints that nobody says more of
_TIE = "velocity over slope of position"


def resolve_units(
    draft: Draft,
    rows: Clean,
    columns: dict[str, list[str]],
    axes: Sequence[str],
    time: str | None,
    step: float,
    relations: list[Relation],
    wraps: Mapping[str, float] | None = None,
) -> dict[str, tuple[str, ...]]:
    """Return kind -> unit of each axis (of time: one), by names, joints, sizes, velocity and position.

    Args:
        draft: takes what is assumed, asked and noted.
        rows: of the columns that are used.
        columns: signal -> its columns, one per axis.
        axes: names of the axes.
        time: the column of time, if there is one.
        step: median step of time [its unit].
        relations: of velocity to position, one per axis.
        wraps: position columns of encoders that wrap -> their ranges.

    Raises:
        InputError: no unit makes such numbers likely, or a stated one is none of its axis.
    """
    stated = stated_units(draft, columns, axes)
    by_time: dict[str, float] = {"s": 1.0}
    why_time = "you said so"
    if time is not None:
        by_time, why_time = time_weights(draft.table.columns[time], draft.roles[time], draft.answers)
    # per row to per unit of time
    counts = [1.0 if slides else draft.answers.counts or 1.0 for slides in stated.linear]  # a turn
    tied = {i: r for i, r in enumerate(relations) if r.likeness > 0.9}
    factors = {i: abs(r.factor) * step * counts[i] for i, r in tied.items()}
    clock, motion = motion_units(draft, rows, columns, stated, by_time, (factors, tied), wraps or {})
    taken = {kind: [t.unit for t in told] for kind, told in motion.items()}
    ratios = {
        i: f / expected(clock.unit, taken["position"][i], taken["velocity"][i])
        for i, f in factors.items()
        if taken["position"][i] != "counts"
    }
    ratio = float(np.median(list(ratios.values()))) if ratios else 1.0
    if time is None and draft.answers.rate_hz is None and abs(ratio - 1) >= 0.1:
        _ask_rate(draft, 1.0 / ratio)
        ratios = {}
    near = [i for i, ratio in ratios.items() if is_near(ratio)]
    for told in (motion[kind][i] for kind in motion for i in near):
        told.because = _and(told.because, _TIE)
    if not (time is None and note_rate(draft, taken, clock.unit, ratios)):
        note_factors(draft, columns, axes, clock.unit, taken, ratios)
    units: dict[str, tuple[str, ...]] = {}
    if time is not None:
        note_clock(draft, time, by_time, why_time, clock.unit)
        why_time = _and(why_time, _TIE) if near else why_time
        units["time"] = _settle(draft, "time", [UnitTold(clock.unit, clock.sure, why_time)], (False,))
    if any(stated.guessed) and draft.answers.counts is None:
        which = [axis for axis, guess in zip(axes, stated.guessed, strict=True) if guess]
        why = "no unit and no model says that an axis is a slide (--unit position=m, or --model)"
        draft.assume("motion", f"{', '.join(which)}: turning", _TURNS, why)
    note_size(draft, columns, rows, taken["position"], stated)
    if signals_of("torque", columns):
        motion["torque"] = torque_units(draft, rows, columns, stated)
    for kind, told in motion.items():
        counted = [columns[kind][i] for i, t in enumerate(told) if t.unit == "counts"]
        units[kind] = _settle(draft, kind, told, stated.linear, _turn(rows, counted, wraps or {}))
    if "velocity" in units:
        ask_tens(draft, units, timed=time is not None)
    ask_range(draft, rows, columns["position"], units["position"])
    ask_constant(draft, columns)
    for kind, usual in (("current", "A"), ("voltage", "V"), ("temperature", "degC")):
        if kind in columns:
            units[kind] = tuple(header_unit(draft, name, kind) or usual for name in columns[kind])
    return units


def _turn(rows: Clean, counted: Sequence[str], wraps: Mapping[str, float]) -> int:
    """Steps a turn of columns that count: where they wrapped, else what they run over; 0 if neither tells."""
    wrapped = {int(wraps[name]) for name in counted if name in wraps}
    if len(wrapped) == 1:
        return turn_that_wraps(wrapped.pop())
    return turn_of(np.column_stack([rows.columns[name] for name in counted])) if counted else 0


def _settle(
    draft: Draft, kind: str, told: list[UnitTold], linear: Sequence[bool], turn: int = 0
) -> tuple[str, ...]:
    """Note a unit; where it is not sure, ask."""
    # in turns until it is known how many counts make one
    turns = {COUNTS_A_SECOND: "turn/s"}
    name, units = f"unit of {kind}", tuple(turns.get(t.unit, t.unit) for t in told)
    if kind in draft.answers.units:
        draft.assume(name, _shown(units), 1.0, draft.answers.because(kind))
        return units
    if "counts" in units:
        draft.questions.append(_counts_question(turn))
        return tuple("turn" if u == "counts" else u for u in units)
    because = "; ".join(dict.fromkeys(part for t in told for part in t.because.split("; ")))
    sure = min(t.sure for t in told)
    if kind == "position" and "turn" in units and draft.answers.counts and "counts" in draft.answers.guessed:
        sure, because = _GUESSED, f"numbers run over {draft.answers.counts:.0f}, read as counts of one turn"
    draft.assume(name, _shown(units), sure, because)
    unsure = [i for i, t in enumerate(told) if t.sure < ASK]
    # once the position's is answered, its slope tells the velocity's
    follows = kind == "velocity" and because.endswith(_TIE) and _asked(draft, "unit.position")
    if unsure and not follows:
        options = _options(kind, units, unsure, linear)
        text = f"What is the unit of {kind}: {' or '.join(options)} ({because})?"
        best = _one(units)
        draft.questions.append(Question(f"unit.{kind}", text, options, best, f"--unit {kind}={best}"))
    return units


def _counts_question(turn: int) -> Question:
    text = "Positions are whole numbers, probably encoder counts. How many counts make a turn?"
    if turn:
        text = f"Positions cover a range of {turn}, probably encoder counts. Is that one turn?"
    best = str(turn) if turn else ""
    return Question("counts", text, (), best, f"--counts {best or 'N'} (or --unit position=deg)")


def _asked(draft: Draft, key: str) -> bool:
    return any(question.key == key for question in draft.questions)


def _options(
    kind: str, units: Sequence[str], unsure: Sequence[int], linear: Sequence[bool]
) -> tuple[str, ...]:
    """Every choice for the axes that are not sure, one for those that move alike; the rest as they are."""
    moves = list(dict.fromkeys(linear[i] for i in unsure))
    out = []
    for choice in product(*(_CHOICES[kind][m] for m in moves)):
        by = dict(zip(moves, choice, strict=True))
        each = [by[linear[i]] if i in unsure else unit for i, unit in enumerate(units)]
        out.append(_one(each))
    return tuple(out)


def _ask_rate(draft: Draft, period: float) -> None:
    """The rate that makes velocity the derivative of position, offered as an answer."""
    rate = FALLBACK_RATE / period if period > 0 else 0.0
    draft.questions = [q for q in draft.questions if q.key != "rate"]
    text = (
        f"No column is time; velocity and position together give {rate:.4g} rows per second. Is that right?"
    )
    draft.questions.append(Question("rate", text, (), f"{rate:.4g}", f"--rate {rate:.4g}"))


def _and(first: str, second: str) -> str:
    return second if first == "rows per second" else f"{first}; {second}"


def _shown(units: Sequence[str]) -> str:
    return units[0] if len(set(units)) == 1 else ", ".join(units)


def ask_constant(draft: Draft, columns: dict[str, list[str]]) -> None:
    """Ask for the torque constants, which no log has, if torque columns are currents by names or units."""
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


def ask_tens(draft: Draft, units: Mapping[str, Sequence[str]], *, timed: bool) -> None:
    """Ask if a velocity is ten, a hundred ... times what it should be.

    Velocity, position or clock is wrong then, and only other information shows which.

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
