"""All that is missing on all axes, solved jointly along the measured motion, and which of it is certain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.comparison import MeasuredMotion
from workbench.core import EffectKey
from workbench.models import AppliedEffect

from ..acceptance import lowers_error
from ..adequacy.adequacy import Adequacy, adequacies
from ..data import Data
from ..fitting.fit import fit
from ..fitting.refinement import with_candidates
from ..hypothesis import Fit
from ..loss import floor_of_judging, rejudged
from ..node import Way, is_consistent, with_last
from ..policy import POLICY
from ..problem import Quest, evaluated
from ..removed_share import removed_share
from ..screening.rivals import rivals_of
from ..screening.stepwise_regression import Selection, selected
from ..screening.torque_regression import Regression
from ..search_result import Stage
from ..significance import INTERVAL, clearness, stands_out


@dataclass(frozen=True)
class Joint:
    """What the joint solution comes to.

    Attributes:
        way: the search after the effects that are certain, or after all where these reach the noise.
        adequacy: how each of them stands against free functions; empty where all is explained.
        near: what helps as well and is not certain.
        size: number of effects that it takes in all.
    """

    way: Way
    adequacy: Mapping[EffectKey, Adequacy]
    near: tuple[AppliedEffect, ...]
    size: int


def jointly(quest: Quest) -> Joint | None:
    """The joint solution; None where no torque was recorded, or nothing helps that is certain."""
    quest.progress("solving for all axes and effects at once, along the measured motion")
    if quest.along is None:
        return None
    data, start, problem = quest.along
    chosen = selected(problem)
    whole = _fitted(problem, chosen, start, data)
    if whole is None:
        return None
    known: dict[EffectKey, Adequacy] = {}
    named: Fit | None = whole
    if not is_consistent(data, whole.mean_squares):
        known = {k: a for k, a in adequacies(whole, start, data).items() if a.holds}
        named = _only(whole, known, data)
    if named is None or not lowers_error(named, start, data):
        return None
    sure = _keys(named)
    kept = Selection(tuple(e for e in chosen.chosen if e.key in sure), chosen.solution)
    way = _in_the_loop(_stages(problem, kept, named, start, data), quest)
    near = tuple(a for a in whole.hypothesis.free if a.key not in sure)
    return None if way is None else Joint(way, known, near, len(chosen.chosen))


def _fitted(problem: Regression, chosen: Selection, current: Fit, data: Data) -> Fit | None:
    """All that was selected and is clearly another than nothing.

    Of two that trade with each other neither is, until one is out: of each axis the least clear goes first.
    """
    if not chosen.chosen:
        return None
    candidates = chosen.candidates()
    found = fit([with_candidates(problem.scene, candidates, current)], data)[0]
    while found is not None:
        doubted: dict[str | None, AppliedEffect] = {}
        for applied in (a for a in found.hypothesis.free if not stands_out(a)):
            weakest = doubted.setdefault(applied.key.axis, applied)
            if clearness(applied) < clearness(weakest):
                doubted[applied.key.axis] = applied
        if not doubted:
            break
        clear = tuple(a for a in found.hypothesis.free if doubted.get(a.key.axis) is not a)
        found = fit([replace(found.hypothesis, free=clear)], data)[0] if clear else None
    return found


def _only(whole: Fit, sure: Mapping[EffectKey, Adequacy], data: Data) -> Fit | None:
    """The effects that are certain, as they are beside all others; deviations cover free functions too.

    Without the others they would stand for a part of these.
    """
    free: list[AppliedEffect] = []
    for applied in whole.hypothesis.free:
        if applied.key not in sure:
            continue
        spread = POLICY.rival_deviation * sure[applied.key].spread
        parameters = {
            name: replace(e, std=float(np.hypot(e.std, spread * abs(e.value))))
            for name, e in applied.parameters.items()
        }
        free.append(AppliedEffect(applied.key, parameters))
    # a part of a law that is certain as a whole may itself be none
    clear = tuple(a for a in free if stands_out(a, INTERVAL))
    if not clear:
        return None
    hypothesis = replace(whole.hypothesis, free=clear)
    return evaluated(hypothesis, data.run([hypothesis.model])[0], data)


def _stages(problem: Regression, chosen: Selection, end: Fit, before: Fit, data: Data) -> list[Stage]:
    """The effects one after the other as they were selected, all with the values of the end."""
    values = {a.key: a for a in end.hypothesis.free}
    order = [values[e.key] for e in chosen.chosen]
    steps = [replace(end.hypothesis, free=tuple(order[: k + 1])) for k in range(len(order))]
    runs = data.run([h.model for h in steps[:-1]])
    fits = [evaluated(h, r, data) for h, r in zip(steps[:-1], runs, strict=True)] + [end]
    floor = floor_of_judging(data)
    stages, previous = [], before
    for entry, fitted in zip(chosen.chosen, fits, strict=True):
        behind, rivals = rivals_of(problem, chosen.chosen, entry)
        stages.append(
            Stage(
                added=entry.key,
                fit=fitted,
                data=data,
                removed_share=removed_share(previous.judged, fitted.judged, floor),
                rivals=rivals,
                others=(),
                dropped=(),
                ranking=(),
                behind=behind,
                folds=(int(np.sum(fitted.agreeing < previous.agreeing)), len(fitted.agreeing)),
                by_held_out=data.held_out_judges,
            )
        )
        previous = fitted
    return stages


def _in_the_loop(stages: Sequence[Stage], quest: Quest) -> Way | None:
    """The stages in the replay that the quest asks for; None where the error does not fall there."""
    data = quest.data
    if not isinstance(data.replay, MeasuredMotion):
        runs = data.run([s.fit.hypothesis.model for s in stages])
        fits = [evaluated(s.fit.hypothesis, r, data) for s, r in zip(stages, runs, strict=True)]
        if not np.isfinite(fits[-1].mean_squares).all() or not lowers_error(fits[-1], quest.start, data):
            return None
        runs_at_all = [f if np.isfinite(f.mean_squares).all() else fits[-1] for f in fits]
        stages = [replace(s, fit=f, data=data) for s, f in zip(stages, runs_at_all, strict=True)]
    before = Way(rejudged(stages[-1].fit, data), data, tuple(stages))
    return with_last(before, stages[-1], quest.seed)


def _keys(found: Fit) -> tuple[EffectKey, ...]:
    return tuple(a.key for a in found.hypothesis.free)
