"""One effect in place of two that have many parameters together, or of two delays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, islice

import numpy as np

from workbench.core import EffectKey
from workbench.models import AppliedEffect

from ..fitting.delays import is_late, one_for_both
from ..fitting.fit import fit
from ..fitting.refinement import polished, with_candidate
from ..hypothesis import Fit, Hypothesis
from ..loss import floor_of_judging, rejudged
from ..node import Way, holds, wanders, with_stages
from ..policy import POLICY
from ..problem import Quest
from ..removed_share import removed_share
from ..screening.compliance import pins_of
from ..screening.sensitivity import Scene
from ..screening.stiction import candidates
from ..search_result import Stage
from ..significance import witnessed


def one_for_two(way: Way, quest: Quest) -> Way:
    """One cause with at most half the parameters that explains as much as two; `way` where there is none.

    A load at the foot is inertia and weight of the linkage at once, and passes for both as long as a third
    cause is missing. Five parameters that are what one would make them are no chance. Of two delays, which
    have one each, one is tried that is as late as both.
    """
    if wanders(way.current) or not holds(way, quest):
        return way  # what explains less has no name
    for pair in combinations(way.current.hypothesis.free, 2):
        if way.data.effort.spent:
            break
        if all(is_late(a.key) for a in pair):
            found = _as_late_as_both(pair, way, quest)
        elif sum(len(a.parameters) for a in pair) >= POLICY.merge_from:
            found = _in_place_of(pair, way, quest)
        else:
            continue
        if found is not None:
            return with_stages(
                Way(quest.start, quest.data), _stages(found, pair, way, quest.start), quest.seed
            )
    return way


def _in_place_of(
    pair: tuple[AppliedEffect, AppliedEffect], way: Way, quest: Quest
) -> tuple[EffectKey, Fit] | None:
    """The effect that does, with its fit beside all others."""
    current, data = way.current, way.data
    one, other = pair
    quest.progress(f"asking whether one cause will do for {one.key} and {other.key}")
    (rest,) = fit([current.hypothesis.without(one.key).without(other.key)], data, iterations=1)
    if rest is None:
        return None
    scene = Scene.of(rest.hypothesis.model, data, rest.simulated, len(data.recordings))
    few = POLICY.merge_size * (current.hypothesis.size - rest.hypothesis.size)
    tried = (
        (c, with_candidate(scene, c, rest))
        for c in candidates(scene, rest, data, quest.seed)
        if c.key not in {one.key, other.key}
    )
    small = ((c, h) for c, h in tried if 0 < h.size - rest.hypothesis.size <= few)
    chosen = list(islice(small, POLICY.merge_candidates))
    return _as_good([(c.key, h) for c, h in chosen], scene, way)


def _as_late_as_both(
    pair: tuple[AppliedEffect, AppliedEffect], way: Way, quest: Quest
) -> tuple[EffectKey, Fit] | None:
    """One delay in place of two that does, with its fit beside all others."""
    current, data = way.current, way.data
    one, other = pair
    quest.progress(f"asking whether one delay will do for {one.key} and {other.key}")
    tried = [(h.free[-1].key, h) for h in one_for_both(current.hypothesis, one, other)]
    scene = Scene.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
    return _as_good(tried, scene, way)


def _as_good(
    tried: Sequence[tuple[EffectKey, Hypothesis]], scene: Scene, way: Way
) -> tuple[EffectKey, Fit] | None:
    """The best of those that explain as much as what was found."""
    current, most = way.current, 1.0 + POLICY.tie
    good = [
        (key, f)
        for (key, _), f in zip(tried, fit([h for _, h in tried], way.data), strict=True)
        if f is not None
        and f.judged <= most * current.judged
        and f.trained <= most * current.trained
        and witnessed(scene, f)
    ]
    return min(good, key=lambda kf: kf[1].judged, default=None)


def _stages(
    found: tuple[EffectKey, Fit], pair: tuple[AppliedEffect, AppliedEffect], way: Way, start: Fit
) -> tuple[Stage, ...]:
    """The way as it would have been with that cause where the first of the two was found."""
    (one, fitted), data = found, way.data
    last, gone = polished(fitted, data), {a.key for a in pair}
    instead = [one if stage.added in gone else stage.added for stage in way.stages]
    order = [key for key in dict.fromkeys(instead) if key in {a.key for a in last.hypothesis.added}]
    fits = fit([_first(last.hypothesis, order[: k + 1]) for k in range(len(order) - 1)], data)
    stages: list[Stage] = []
    before = rejudged(start, data)
    for key, now in zip(order, (*(f or last for f in fits), last), strict=True):
        removed = removed_share(before.judged, now.judged, floor_of_judging(data))
        stage = next((s for s in way.stages if s.added == key), None) or Stage(
            added=key,
            fit=now,
            data=data,
            removed_share=removed,
            rivals=pins_of(last.hypothesis.base, key),
            others=(),
            dropped=(),
            ranking=((key, removed),),
            behind=(),
            folds=(0, 0),
            by_held_out=data.held_out_judges,
        )
        folds = int(np.sum(now.agreeing < before.agreeing)), len(now.agreeing)
        stages.append(replace(stage, fit=now, data=data, removed_share=removed, dropped=(), folds=folds))
        before = now
    return tuple(stages)


def _first(hypothesis: Hypothesis, keys: Sequence[EffectKey]) -> Hypothesis:
    """Only these of its effects."""
    free, stated = (tuple(a for a in of if a.key in keys) for of in (hypothesis.free, hypothesis.stated))
    return replace(hypothesis, free=free, stated=stated)
