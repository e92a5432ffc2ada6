"""Refinement of backlash on a grid, because diverging trajectories have no useful derivatives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import reduce
from itertools import product

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named, kinds
from workbench.models import AppliedEffect, Model, Placement

from ..data import Data
from ..fitting.fit import FINE_TOLERANCE, fit, values_of
from ..hypothesis import Fit, Hypothesis, applied_effect
from ..node import Node, with_last_step
from ..policy import POLICY
from ..problem import Problem

_STEPS = (0.1, 0.04, 0.015)  # of each parameter, one after the other
_ROUNDS = 3  # at each step, as long as the best is on the rim of the grid


def with_refined_gap(node: Node, problem: Problem) -> Iterator[Node]:
    """Return the node with the parameters of diverging effects refined on a grid."""
    problem.progress("trying sizes of the gap")
    better = refined_on_grid(node.current, node.data)
    if better is not node.current:
        last = replace(node.steps[-1], fit=better)
        yield with_last_step(node.begun(as_good=True), last, problem.seed)


def refined_on_grid(found: Fit, data: Data) -> Fit:
    """Return the fit with the parameters of diverging effects refined on a grid; the same fit if nothing is
    better.

    Many runs side by side show where less is left, as long as they diverge late. The test loss has to fall
    too.

    Args:
        found: a fit.
        data: recordings and weights.
    """
    loose = [a for a in found.hypothesis.free if kinds.diverges(effect_named(a.key.effect))]
    some = data.part(data.most_informative(found.mean_squares, POLICY.informative_share))
    hypothesis = found.hypothesis
    for applied in loose:
        for step in _STEPS:
            hypothesis = _downhill(hypothesis, applied.key, step, some)
    better = found if hypothesis is found.hypothesis else fit([hypothesis], data, 1)[0]
    less = 1.0 - POLICY.tie
    if (
        better is None
        or better.test_loss > less * found.test_loss
        or better.training_loss > less * found.training_loss
    ):
        better = found
    return _with_others_converged(better, data)


def _with_others_converged(found: Fit, data: Data) -> Fit:
    """Return the fit with the parameters of all other effects converged beside these.

    Runs that diverge are no reason to stop on the way: while the gap is held, slopes lead down.
    """
    free = found.hypothesis.free
    held = [a for a in free if kinds.diverges(effect_named(a.key.effect))]
    others = tuple(a for a in free if a not in held)
    if not held or not others:
        return found
    base = reduce(Model.with_effect, held, found.hypothesis.base)
    fitted = fit([replace(found.hypothesis, base=base, free=others)], data, enough=FINE_TOLERANCE)[0]
    if fitted is None or not fitted.training_loss < found.training_loss:
        return found
    now = {a.key: a for a in (*held, *fitted.hypothesis.free)}
    whole = fit([replace(found.hypothesis, free=tuple(now[a.key] for a in free))], data, 1)[0]
    return found if whole is None else whole


def _downhill(hypothesis: Hypothesis, key: EffectKey, step: float, data: Data) -> Hypothesis:
    """Return the hypothesis after moving the grid to its best point until that is the middle."""
    for _ in range(_ROUNDS):
        around = _around(hypothesis, next(a for a in hypothesis.free if a.key == key), step)
        best = int(np.argmin(values_of(around, data)))
        if best == 0:
            break
        hypothesis = around[best]
    return hypothesis


def _around(hypothesis: Hypothesis, applied: AppliedEffect, step: float) -> list[Hypothesis]:
    """Return the hypothesis, and variants with an effect's nonlinear values one grid step up and down."""
    effect = effect_named(applied.key.effect)
    bounds = effect.parameters.shape_bounds(hypothesis.base, Placement.of(hypothesis.base, applied.key))
    out = [hypothesis]
    for signs in product((-1.0, 0.0, 1.0), repeat=len(effect.parameters.nonlinear)):
        if not any(signs):
            continue
        values = dict(applied.values)
        for name, sign in zip(effect.parameters.nonlinear, signs, strict=True):
            values[name] = float(np.clip(values[name] * (1.0 + step) ** sign, *bounds[name]))
        moved = applied_effect(hypothesis.base, applied, values)
        free = tuple(moved if a.key == applied.key else a for a in hypothesis.free)
        out.append(replace(hypothesis, free=free))
    return out
