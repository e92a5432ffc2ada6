"""Differences between stated units and numbers: the stated unit is kept, and the difference is reported."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .clean import Clean
from .draft import Draft
from .scales import expected
from .stated import Stated
from .units import by_size, is_linear

_FITS = 0.05  # by how much a factor may miss a unit's
_UNLIKELY = 1e-3  # weight of a unit by size, below which it is said
_OTHERS = {
    "position": ("rad", "deg", "turn", "m", "mm"),
    "velocity": ("rad/s", "deg/s", "rpm", "turn/s", "m/s", "mm/s"),
}


def is_near(ratio: float) -> bool:
    """Return whether a velocity may be the derivative: noise lowers the factor, units change it more."""
    return 0.8 < ratio < 1.25


def note_clock(draft: Draft, time: str, weights: Mapping[str, float], why: str, taken: str) -> None:
    """Report if velocities contradict the unit in the name of the clock."""
    stated = max(weights, key=lambda u: weights[u])
    if why.startswith("its name") and stated != taken:
        draft.notes.append(
            f"The name of '{time}' says {stated}, but velocity over slope of position says {taken}: "
            f"{taken} is used. If that is wrong: --unit time={stated}"
        )


def note_factors(
    draft: Draft,
    columns: dict[str, list[str]],
    axes: Sequence[str],
    clock: str,
    units: Mapping[str, Sequence[str]],
    ratios: Mapping[int, float],
) -> None:
    """Report if velocity is not the derivative of position in the assumed units.

    Args:
        draft: takes the notes.
        columns: signal -> its columns, one per axis.
        axes: names of the axes.
        clock: unit of time.
        units: ``position`` and ``velocity`` -> unit of each axis.
        ratios: axis -> velocity over the derivative of position in these units.
    """
    left = [i for i, ratio in ratios.items() if not is_near(ratio)]
    while left:
        pair = _pair(units, left[0])
        same = [i for i in left if _pair(units, i) == pair and abs(ratios[i] / ratios[left[0]] - 1) < 0.2]
        left = [i for i in left if i not in same]
        ratio = float(np.median([ratios[i] for i in same]))
        fitting = {kind: _fitting(kind, clock, pair, ratio) for kind in ("velocity", "position")}
        kind = next((k for k, unit in fitting.items() if unit), None)
        if kind is None:
            which = ", ".join(axes[i] for i in same)
            draft.notes.append(
                f"Velocity of {which} is {ratio:.4g} times the derivative of position in these units: "
                "a gear ratio, or a wrong unit?"
            )
            continue
        either = " or ".join(f"{k} in {unit}" for k, unit in fitting.items() if unit)
        each = [fitting[kind] if i in same else unit for i, unit in enumerate(units[kind])]
        draft.notes.append(
            f"{_named(columns['velocity'], same)} is {ratio:.4g} times the derivative of "
            f"{_named(columns['position'], same)}: the data say {either}. {pair[1]} and {pair[0]} are "
            f"used, as stated. If that is wrong: --unit {kind}={','.join(each)}"
        )


def note_rate(
    draft: Draft, units: Mapping[str, Sequence[str]], clock: str, ratios: Mapping[int, float]
) -> bool:
    """Report if a stated rate makes all velocities wrong by the same factor; return whether it does.

    Args:
        draft: takes the note.
        units: ``position`` and ``velocity`` -> unit of each axis.
        clock: unit of time.
        ratios: axis -> velocity over the derivative of position in these units.
    """
    rate, each = draft.answers.rate_hz, np.array(list(ratios.values()))
    if rate is None or len(each) < 2 or is_near(float(np.median(each))) or np.ptp(each) > _FITS * each.min():
        return False
    if any(_fitting(kind, clock, _pair(units, i), r) for i, r in ratios.items() for kind in _OTHERS):
        return False
    ratio = float(np.median(each))
    draft.notes.append(
        f"At {rate:g} rows per second velocity is {ratio:.4g} times the derivative of position on every "
        f"axis: the data say {ratio * rate:.4g} rows per second. {rate:g} is used, as stated. If that "
        f"is wrong: --rate {ratio * rate:.4g}"
    )
    return True


def note_size(
    draft: Draft, columns: dict[str, list[str]], rows: Clean, units: Sequence[str], stated: Stated
) -> None:
    """Report if positions are far too large for the unit in their names."""
    odd: dict[tuple[str, str], list[int]] = {}
    for i, unit in enumerate(units):
        values = rows.columns[columns["position"][i]][:, None]
        weights = by_size("position", values, stated.linear[i])
        if stated.because["position"][i] == "its name says so" and weights.get(unit, 1.0) < _UNLIKELY:
            odd.setdefault((unit, max(weights, key=lambda u: weights[u])), []).append(i)
    for (unit, other), which in odd.items():
        top = max(float(np.nanmax(np.abs(rows.columns[columns["position"][i]]))) for i in which)
        each = [other if i in which else u for i, u in enumerate(units)]
        draft.notes.append(
            f"{_named(columns['position'], which)} goes up to {top:.3g}: by size it is {other}. {unit} "
            f"is used, as its name says. If that is wrong: --unit position={','.join(each)}"
        )


def _pair(units: Mapping[str, Sequence[str]], i: int) -> tuple[str, str]:
    return units["position"][i], units["velocity"][i]


def _fitting(kind: str, clock: str, pair: tuple[str, str], ratio: float) -> str:
    """Another unit of a kind that would make the velocity the derivative, ``""`` where there is none."""
    p, v = pair
    factor = ratio * expected(clock, p, v)
    own = p if kind == "position" else v
    for unit in _OTHERS[kind]:
        if unit != own and is_linear(unit, kind) == is_linear(own, kind):
            now = expected(clock, unit, v) if kind == "position" else expected(clock, p, unit)
            if abs(factor / now - 1) < _FITS:
                return unit
    return ""


def _named(names: Sequence[str], which: Sequence[int]) -> str:
    more = f" (and the same on {len(which) - 1} more axes)" if len(which) > 1 else ""
    return f"'{names[which[0]]}'{more}"
