"""Factors of columns: for opposite signs, counts, or a unit that differs from that of the axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from workbench.core import AXIS_SIGNALS

from .draft import Draft
from .match import Relation
from .stated import EXAMPLES, header_unit
from .units import is_linear, scale


def resolve_scales(
    draft: Draft,
    columns: dict[str, list[str]],
    axes: Sequence[str],
    units: Mapping[str, Sequence[str]],
    relations: list[Relation],
) -> dict[str, list[float]]:
    """Return signal -> one factor per axis, where one is not 1.

    Args:
        draft: takes what is assumed and noted.
        columns: signal -> its columns, one per axis.
        axes: names of the axes.
        units: kind -> unit of each axis.
        relations: of velocity to position, one per axis; none where no velocity was logged.
    """
    factors = {
        signal: [_factor(draft, signal, column, unit) for column, unit in zip(names, own, strict=True)]
        for signal, names in columns.items()
        if (own := units.get(AXIS_SIGNALS[signal])) is not None
    }
    backward = [
        i
        for i, r in enumerate(relations)
        if r.likeness > 0.9
        and r.factor * scale(units["position"][i], "position") * scale(units["velocity"][i], "velocity") < 0
    ]
    if backward:
        for i in backward:
            factors["velocity"][i] *= -1.0
        which = ", ".join(axes[i] for i in backward)
        draft.assume("sign of velocity", f"reversed: {which}", 0.95, "it falls where position rises")
        draft.notes.append(
            f"Velocity of {which} has the opposite sign to the slope of position; it is negated. Is the "
            "encoder reversed?"
        )
    return {signal: each for signal, each in factors.items() if set(each) != {1.0}}


def _factor(draft: Draft, signal: str, column: str, unit: str) -> float:
    """From a column's own unit to its axis'."""
    kind = AXIS_SIGNALS[signal]
    if kind not in EXAMPLES or kind in draft.answers.units:
        return 1.0
    if kind == "position" and draft.answers.counts and not is_linear(unit, kind):
        return 1.0 / draft.answers.counts
    own = header_unit(draft, column, kind)
    if not own or own == unit or is_linear(own, kind) != is_linear(unit, kind):
        return 1.0
    return scale(own, kind) / scale(unit, kind)
