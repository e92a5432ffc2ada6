"""Units: what is sure is noted as an assumption, what is not becomes a question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from workbench.core import InputError

from .clean import Clean
from .clock import time_weights
from .counts import turn_of
from .disagree import is_near, note_clock, note_factors, note_rate, note_size
from .draft import FALLBACK_RATE, Draft
from .match import Relation
from .proposal import ASK, Question
from .scales import Motion, Told, expected, weigh
from .stated import Stated, header_unit, signals_of, stated_units
from .units import by_size

_CHOICES = {
    "time": (("s", "ms", "us", "ns"), ()),
    "position": (("rad", "deg"), ("m", "mm")),
    "velocity": (("rad/s", "deg/s", "rpm"), ("m/s", "mm/s")),
    "torque": (("N*m", "mN*m", "N*mm"), ("N",)),
}
_GUESSED = 0.8
_TURNS = 0.9  # of joints that nobody says more of
_TIE = "velocity over slope of position"


@dataclass
class _Told:
    """A unit of one axis, as it was told."""

    unit: str
    sure: float
    because: str


def settle_units(
    draft: Draft,
    rows: Clean,
    columns: dict[str, list[str]],
    axes: Sequence[str],
    time: str | None,
    step: float,
    relations: list[Relation],
) -> dict[str, tuple[str, ...]]:
    """Kind -> unit of each axis (of time: one), by names, joints, sizes, and velocity against position.

    Args:
        draft: takes what is assumed, asked and noted.
        rows: of the columns that are used.
        columns: signal -> its columns, one an axis.
        axes: names of the axes.
        time: the column of time, if there is one.
        step: median step of time [its unit].
        relations: of velocity to position, one an axis.

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
    factors = {i: abs(r.factor) * step * counts[i] for i, r in enumerate(relations) if r.likeness > 0.9}
    clock, motion = _motion(draft, rows, columns, stated, by_time, factors)
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
        units["time"] = _settle(draft, "time", [_Told(clock.unit, clock.sure, why_time)], (False,))
    if any(stated.guessed) and draft.answers.counts is None:
        which = [axis for axis, guess in zip(axes, stated.guessed, strict=True) if guess]
        why = "no unit and no model says that one slides (--unit position=m, or --model)"
        draft.assume("motion", f"{', '.join(which)}: turning", _TURNS, why)
    note_size(draft, columns, rows, taken["position"], stated)
    if signals_of("torque", columns):
        motion["torque"] = _torques(rows, columns, stated)
    for kind, told in motion.items():
        counts_of = [i for i, t in enumerate(told) if t.unit == "counts"]
        turn = (
            turn_of(np.column_stack([rows.columns[columns[kind][i]] for i in counts_of])) if counts_of else 0
        )
        units[kind] = _settle(draft, kind, told, stated.linear, turn)
    for kind, usual in (("current", "A"), ("voltage", "V"), ("temperature", "degC")):
        if kind in columns:
            units[kind] = tuple(header_unit(draft, name, kind) or usual for name in columns[kind])
    return units


def _motion(
    draft: Draft,
    rows: Clean,
    columns: dict[str, list[str]],
    stated: Stated,
    by_time: dict[str, float],
    factors: Mapping[int, float],
) -> tuple[Told, dict[str, list[_Told]]]:
    """The clock's unit, and those of ``position`` and, where it was logged, ``velocity``, one an axis."""
    kinds = [kind for kind in ("position", "velocity") if kind in columns]
    groups: dict[tuple, list[int]] = {}
    for i, linear in enumerate(stated.linear):
        groups.setdefault((linear, *(stated.units[kind][i] for kind in kinds)), []).append(i)
    weights = [
        {kind: _weights(kind, rows, columns, stated, which) for kind in kinds} for which in groups.values()
    ]
    motions = []
    for which, by in zip(groups.values(), weights, strict=True):
        good = [factors[i] for i in which if i in factors]
        factor = float(np.median(good)) if good else None
        motions.append(Motion(by["position"][0], by.get("velocity", ({}, ""))[0], factor))
    told = weigh(by_time, motions)
    if told is None:
        raise InputError(
            "the unit of position cannot be told from such numbers", file=draft.table.file,
            remedy="say it: --unit position=deg (or rad, mm, ...; one, or one an axis)",
        )  # fmt: skip
    clock, each = told
    out: dict[str, list[_Told]] = {kind: [_Told("", 0.0, "")] * len(stated.linear) for kind in kinds}
    for which, by, found in zip(groups.values(), weights, each, strict=True):
        for kind in kinds:
            for i in which:
                out[kind][i] = _Told(found[kind].unit, found[kind].sure, by[kind][1])
    return clock, out


def _torques(rows: Clean, columns: dict[str, list[str]], stated: Stated) -> list[_Told]:
    groups: dict[tuple[bool, str], list[int]] = {}
    for i, linear in enumerate(stated.linear):
        groups.setdefault((linear, stated.units["torque"][i]), []).append(i)
    out = [_Told("", 0.0, "")] * len(stated.linear)
    for which in groups.values():
        weights, why = _weights("torque", rows, columns, stated, which)
        best = max(weights, key=lambda u: weights[u])
        for i in which:
            out[i] = _Told(best, weights[best] / sum(weights.values()), why)
    return out


def _weights(
    kind: str, rows: Clean, columns: dict[str, list[str]], stated: Stated, which: Sequence[int]
) -> tuple[dict[str, float], str]:
    """Weights of the units of some axes that are alike, and what they rest on."""
    first = which[0]
    if unit := stated.units[kind][first]:
        return {unit: 1.0}, stated.because[kind][first]
    signals = signals_of(kind, columns) if kind == "torque" else [kind]
    values = np.column_stack([rows.columns[columns[s][i]] for s in signals for i in which])
    by = {u: w for u, w in by_size(kind, values, stated.linear[first]).items() if w > 0}
    if stated.linear[first] and stated.modelled[first]:
        return by, "a slide in the model"
    return by, f"numbers up to {np.nanmax(np.abs(values)):.3g}"


def _settle(
    draft: Draft, kind: str, told: list[_Told], linear: Sequence[bool], turn: int = 0
) -> tuple[str, ...]:
    """Note a unit; where it is not sure, ask."""
    name, units = f"unit of {kind}", tuple(t.unit for t in told)
    if kind in draft.answers.units:
        draft.assume(name, _shown(units), 1.0, "you said so")
        return units
    if "counts" in units:
        draft.questions.append(_counts_question(turn))
        return tuple("turn" if u == "counts" else u for u in units)
    because = "; ".join(dict.fromkeys(part for t in told for part in t.because.split("; ")))
    sure = min(t.sure for t in told)
    if kind == "position" and "turn" in units and draft.answers.counts and "counts" in draft.answers.guessed:
        sure, because = _GUESSED, f"numbers run over {draft.answers.counts:.0f}, taken for counts of one turn"
    draft.assume(name, _shown(units), sure, because)
    unsure = [i for i, t in enumerate(told) if t.sure < ASK]
    if unsure:
        options = _options(kind, units, unsure, linear)
        text = f"What is the unit of {kind}: {' or '.join(options)} ({because})?"
        best = units[0] if len(set(units)) == 1 else ",".join(units)
        draft.questions.append(Question(f"unit.{kind}", text, options, best, f"--unit {kind}={best}"))
    return units


def _counts_question(turn: int) -> Question:
    text = "Positions are whole numbers, encoder counts it seems. How many make a turn?"
    if turn:
        text = f"Positions run over a turn of {turn} encoder counts, it seems. Do as many make a turn?"
    best = str(turn) if turn else ""
    return Question("counts", text, (), best, f"--counts {best or 'N'} (or --unit position=deg)")


def _options(
    kind: str, units: Sequence[str], unsure: Sequence[int], linear: Sequence[bool]
) -> tuple[str, ...]:
    """Every choice for the axes that are not sure, one for those that move alike; the rest as they are."""
    moves = list(dict.fromkeys(linear[i] for i in unsure))
    out = []
    for choice in product(*(_CHOICES[kind][m] for m in moves)):
        by = dict(zip(moves, choice, strict=True))
        each = [by[linear[i]] if i in unsure else unit for i, unit in enumerate(units)]
        out.append(each[0] if len(set(each)) == 1 else ",".join(each))
    return tuple(out)


def _ask_rate(draft: Draft, period: float) -> None:
    """The rate that makes velocity the derivative of position, offered as an answer."""
    rate = FALLBACK_RATE / period if period > 0 else 0.0
    draft.questions = [q for q in draft.questions if q.key != "rate"]
    text = f"No column is time; velocity against position says {rate:.4g} rows a second. Is that so?"
    draft.questions.append(Question("rate", text, (), f"{rate:.4g}", f"--rate {rate:.4g}"))


def _and(first: str, second: str) -> str:
    return second if first.startswith("numbers") or first == "rows a second" else f"{first}; {second}"


def _shown(units: Sequence[str]) -> str:
    return units[0] if len(set(units)) == 1 else ", ".join(units)
