"""What else would explain the torque as well in place of one effect, beside all others."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import EffectKey

from ..moves.choice import behind, same_cause
from ..policy import POLICY
from .screen import Entry
from .stepwise_regression import fits_in
from .torque_regression import Regression


def rivals_of(
    problem: Regression, chosen: Sequence[Entry], entry: Entry
) -> tuple[tuple[tuple[EffectKey, float], ...], tuple[EffectKey, ...]]:
    """Other effects that stand for one: what they leave on its axis over what it leaves, and which tie.

    Args:
        problem: the linear problem.
        chosen: all effects of the solution.
        entry: one of them.
    """
    others = tuple(e for e in chosen if e is not entry)
    left, without = problem.left(tuple(chosen)), problem.left(others)
    axis = int((without - left).argmax())
    least: dict[EffectKey, float] = {}
    for other in problem.entries:
        if same_cause(other.key, entry.key) or axis not in problem.axes_of(other):
            continue
        if fits_in((other,), others) and _stands_for(problem, chosen, entry, other):
            now = float(problem.left((*others, other))[axis])
            least[other.key] = min(now, least.get(other.key, now))
    found = behind(entry.key, float(left[axis]), least.items())
    return found, tuple(key for key, times in found if times <= 1.0 + POLICY.tie)


def _stands_for(problem: Regression, chosen: Sequence[Entry], entry: Entry, other: Entry) -> bool:
    """Whether beside another effect one has little left to explain of what it explains without.

    Where much stays unknown, what explains another part of it removes as much, and is no other name for it.
    """
    others = tuple(e for e in chosen if e is not entry)
    alone = problem.left(others).sum() - problem.left(tuple(chosen)).sum()
    beside = problem.left((*others, other)).sum() - problem.left((*chosen, other)).sum()
    return bool(beside <= POLICY.exchange_left * alone)
