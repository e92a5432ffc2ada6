"""Alternatives: other effects that explain the torque as well as one effect does, beside all others."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import EffectKey

from ..moves.choice import loss_ratios, same_cause
from ..policy import POLICY
from .equations import Entry
from .stepwise_regression import fits_in
from .torque_regression import Regression


def rivals_of(
    regression: Regression, chosen: Sequence[Entry], entry: Entry
) -> tuple[tuple[tuple[EffectKey, float], ...], tuple[EffectKey, ...]]:
    """Return loss ratios of the effects that could replace one on its axis, and those indistinguishable from
    it.

    Args:
        regression: the linear problem.
        chosen: all effects of the solution.
        entry: one of them.
    """
    others = tuple(e for e in chosen if e is not entry)
    left, without = regression.left(tuple(chosen)), regression.left(others)
    axis = int((without - left).argmax())
    least: dict[EffectKey, float] = {}
    for other in regression.entries:
        alike = same_cause(other.key, entry.key) or other.is_extended
        if alike or axis not in regression.axes_of(other):
            continue
        if fits_in((other,), others) and _stands_for(regression, chosen, entry, other):
            now = float(regression.left((*others, other))[axis])
            least[other.key] = min(now, least.get(other.key, now))
    found = loss_ratios(entry.key, float(left[axis]), least.items())
    return found, tuple(key for key, times in found if times <= 1.0 + POLICY.tie)


def _stands_for(regression: Regression, chosen: Sequence[Entry], entry: Entry, other: Entry) -> bool:
    """Return whether an effect has little left to explain beside another, compared with what it explains
    alone.

    Where much stays unknown, what explains another part of it removes as much, and is no other name for it.
    """
    others = tuple(e for e in chosen if e is not entry)
    alone = regression.left(others).sum() - regression.left(tuple(chosen)).sum()
    beside = regression.left((*others, other)).sum() - regression.left((*chosen, other)).sum()
    return bool(beside <= POLICY.exchange_left * alone)
