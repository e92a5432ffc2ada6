"""One effect with few parameters in place of two that have many together."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

from workbench.models import AppliedEffect

from .fit import fit
from .giving import pins_of
from .hypothesis import Fit
from .judging import TIE, witnessed
from .refining import polished, with_candidate
from .screen import Candidate
from .sensitivity import Scene
from .stage import Stage
from .sticking import candidates
from .ways import Quest, Way, wanders, with_stages

_MANY = 4  # parameters of two effects from which it is asked
_LESS = 0.5  # of them: what one in their place may have
_TRIED = 2  # candidates a pair


def one_for_two(way: Way, quest: Quest) -> Way:
    """One cause with at most half the parameters that explains as much as two; `way` where there is none.

    A load at the foot is inertia and weight of the linkage at once, and passes for both as long as a third
    cause is missing. Five parameters that are what one would make them are no chance.
    """
    if wanders(way.current):
        return way
    for pair in combinations(way.current.hypothesis.free, 2):
        if way.data.effort.spent or sum(len(a.parameters) for a in pair) < _MANY:
            continue
        found = _in_place_of(pair, way, quest)
        if found is not None:
            return with_stages(Way(quest.start, quest.data), _stages(found, pair, way), quest.seed)
    return way


def _in_place_of(
    pair: tuple[AppliedEffect, AppliedEffect], way: Way, quest: Quest
) -> tuple[Candidate, Fit] | None:
    """The effect that does, with its fit beside all others."""
    current, data = way.current, way.data
    one, other = pair
    quest.progress(f"asking whether one cause will do for {one.key} and {other.key}")
    (rest,) = fit([current.hypothesis.without(one.key).without(other.key)], data, iterations=1)
    if rest is None:
        return None
    scene = Scene.of(rest.hypothesis.model, data, rest.simulated, len(data.recordings))
    few = _LESS * sum(len(a.parameters) for a in pair)
    known = {a.key for a in pair}
    chosen: list[Candidate] = []
    for candidate in candidates(scene, rest, data, quest.seed):
        made = with_candidate(scene, candidate, rest)
        more = sum(len(a.parameters) for a in made.free) - sum(
            len(a.parameters) for a in rest.hypothesis.free
        )
        if candidate.key not in known and 0 < more <= few and len(chosen) < _TRIED:
            chosen.append(candidate)
    fits = fit([with_candidate(scene, c, rest) for c in chosen], data)
    most = 1.0 + TIE
    good = [
        (c, f)
        for c, f in zip(chosen, fits, strict=True)
        if f is not None
        and f.judged <= most * current.judged
        and f.trained <= most * current.trained
        and witnessed(scene, f)
    ]
    return min(good, key=lambda cf: cf[1].judged, default=None)


def _stages(
    found: tuple[Candidate, Fit], pair: tuple[AppliedEffect, AppliedEffect], way: Way
) -> tuple[Stage, ...]:
    """The way as it would have been with that cause where the first of the two was found."""
    (candidate, fitted), data = found, way.data
    last = polished(fitted, data)
    gone = {a.key for a in pair}
    added = {a.key: a for a in last.hypothesis.added}
    order = []
    for stage in way.stages:
        key = candidate.key if stage.added in gone else stage.added
        if key in added and key not in order:
            order.append(key)
    subsets = [
        replace(
            last.hypothesis,
            free=tuple(a for a in last.hypothesis.free if a.key in order[: k + 1]),
            stated=tuple(a for a in last.hypothesis.stated if a.key in order[: k + 1]),
        )
        for k in range(len(order))
    ]
    fits = [*fit(subsets[:-1], data), last]
    own = {s.added: s for s in way.stages if s.added not in gone}
    first = next(s for s in way.stages if s.added in gone)
    stages = []
    for key, now in zip(order, fits, strict=True):
        stage = own.get(key) or replace(
            first,
            added=key,
            rivals=pins_of(last.hypothesis.base, key),
            others=(),
            behind=(),
        )
        stages.append(replace(stage, fit=now or last, data=data, dropped=()))
    return tuple(stages)
