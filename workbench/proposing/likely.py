"""Unstated units: by the size of numbers, by the derivative of position, by the range of encoders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import InputError

from .clean import Clean
from .draft import Draft
from .match import Relation
from .scales import AxisMotion, UnitGuess, weigh
from .stated import Stated, signals_of
from .units import by_size, equations
from .wraps import unit_of_range

_SIZE = "numbers"
_LIKELY = 0.96  # of a unit by size alone
_OTHERS = 1e-4  # weight of the units in which no encoder wraps at such a range


@dataclass
class UnitTold:
    """A unit of one axis, as it was told."""

    unit: str
    sure: float
    because: str


def motion_units(
    draft: Draft,
    rows: Clean,
    columns: dict[str, list[str]],
    stated: Stated,
    by_time: dict[str, float],
    tied: tuple[Mapping[int, float], Mapping[int, Relation]],
    wraps: Mapping[str, float],
) -> tuple[UnitGuess, dict[str, list[UnitTold]]]:
    """Return the unit of the clock, and of ``position`` and, if logged, ``velocity``, one per axis.

    Args:
        draft: what the user says, and the names of the columns.
        rows: of the columns that are used.
        columns: signal -> its columns, one per axis.
        stated: units that are stated.
        by_time: weights of the clock's units.
        tied: axis -> velocity over slope of position [own units], and their relation, where they are alike.
        wraps: position columns of encoders that wrap -> their ranges.

    Raises:
        InputError: no unit makes such numbers likely.
    """
    factors, relations = tied
    kinds = [kind for kind in ("position", "velocity") if kind in columns]
    groups: dict[tuple, list[int]] = {}
    for i, linear in enumerate(stated.linear):
        groups.setdefault((linear, *(stated.units[kind][i] for kind in kinds)), []).append(i)
    weights = [
        {
            kind: _weights(draft, kind, rows, columns, stated, which, not factors.keys().isdisjoint(which))
            for kind in kinds
        }
        for which in groups.values()
    ]
    motions = []
    for which, by in zip(groups.values(), weights, strict=True):
        good = [factors[i] for i in which if i in factors]
        factor = float(np.median(good)) if good else None
        alike = max([relations[i].likeness for i in which if i in relations], default=0.9)
        position = _by_range(by["position"][0], [wraps.get(columns["position"][i], 0.0) for i in which])
        motions.append(AxisMotion(position, by.get("velocity", ({}, ""))[0], factor, alike))
    told = weigh(by_time, motions)
    if told is None:
        raise InputError(
            "the unit of position cannot be told from such numbers", file=draft.table.file,
            remedy="state it: --unit position=deg (or rad, mm, ...; one, or one per axis)",
        )  # fmt: skip
    clock, each = told
    out: dict[str, list[UnitTold]] = {kind: [UnitTold("", 0.0, "")] * len(stated.linear) for kind in kinds}
    for which, by, found in zip(groups.values(), weights, each, strict=True):
        for kind in kinds:
            for i in which:
                # what only its size tells is never sure: another unit may have such numbers too
                most = 1.0 if stated.units["position"][i] or not by[kind][1].startswith(_SIZE) else _LIKELY
                out[kind][i] = UnitTold(found[kind].unit, min(found[kind].sure, most), by[kind][1])
    return clock, out


def torque_units(draft: Draft, rows: Clean, columns: dict[str, list[str]], stated: Stated) -> list[UnitTold]:
    """Return the unit of torque of each axis."""
    groups: dict[tuple[bool, str], list[int]] = {}
    for i, linear in enumerate(stated.linear):
        groups.setdefault((linear, stated.units["torque"][i]), []).append(i)
    out = [UnitTold("", 0.0, "")] * len(stated.linear)
    for which in groups.values():
        weights, why = _weights(draft, "torque", rows, columns, stated, which)
        best = max(weights, key=lambda u: weights[u])
        for i in which:
            most = _LIKELY if why.startswith(_SIZE) else 1.0
            out[i] = UnitTold(best, min(most, weights[best] / sum(weights.values())), why)
    return out


def _weights(
    draft: Draft,
    kind: str,
    rows: Clean,
    columns: dict[str, list[str]],
    stated: Stated,
    which: Sequence[int],
    tied: bool = False,
) -> tuple[dict[str, float], str]:
    """Weights of the units of some axes that are alike, and what they rest on."""
    first = which[0]
    if unit := stated.units[kind][first]:
        return {unit: 1.0}, stated.because[kind][first]
    signals = signals_of(kind, columns) if kind == "torque" else [kind]
    values = np.column_stack([rows.columns[columns[s][i]] for s in signals for i in which])
    symbols = all(equations(draft.roles[columns[kind][i]].words) for i in which) if kind in columns else False
    sizes = by_size(kind, values, stated.linear[first], symbols=symbols, tied=tied)
    if kind == "velocity" and (turn := draft.answers.counts) and tied:
        sizes[f"{1 / turn:.9g}*turn/s"] = sizes["turn/s"]
    by = {u: w for u, w in sizes.items() if w > 0}
    if stated.linear[first] and stated.modelled[first]:
        return by, "a slide in the model"
    return by, f"{_SIZE} up to {np.nanmax(np.abs(values)):.3g}"


def _by_range(weights: dict[str, float], ranges: Sequence[float]) -> dict[str, float]:
    """Weights with what the ranges say at which encoders wrap, where one does."""
    units = {unit_of_range(size) for size in ranges if size} & weights.keys()
    return {unit: w if unit in units else _OTHERS * w for unit, w in weights.items()} if units else weights
