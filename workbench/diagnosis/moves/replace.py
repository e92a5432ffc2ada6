"""Other causes in place of one that was taken while others were still missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..acceptance import mends, nearly_at_floor
from ..fitting.fit import fit
from ..fitting.refinement import polished, with_candidate
from ..hypothesis import Fit
from ..loss import explained, floor_of_judging
from ..node import Way, onwards, wanders, with_stages
from ..policy import POLICY
from ..problem import Quest
from ..removed_share import removed_share, removed_shares
from ..screening.compliance import pins_of, what_gives_way
from ..screening.sensitivity import Scene
from ..screening.stiction import candidates
from ..search_result import Stage, has_cause
from ..significance import witnessed
from .choice import Explanation, Judged, behind


def others_instead(way: Way, quest: Quest) -> Way:
    """Others in place of causes beside which they did nearly as well; `way` where none does much better.

    While a delay is missing, a spring in the pin passes for one at the drive: only where all other causes are
    there can it be told which one it is. In place of the last cause, others may lead on to one more. Asked
    where nearly all is explained and yet more than noise is left: what explains less has no wrong name.
    """
    share = explained(quest.data, quest.start, way.current, way.data)
    if not way.stages or share < POLICY.explained or wanders(way.current):
        return way
    for stage in reversed(way.stages):
        if way.done or way.data.effort.spent:
            return way
        found = _in_its_place(stage, way, quest)
        if found and mends(found[0].fit, way.current, way.data):
            way = onwards(with_stages(way, found[:1], quest.seed), quest)
        elif stage is way.stages[-1] and not nearly_at_floor(way.current, way.data):
            one_more = replace(quest, limit=1)
            led = [onwards(with_stages(way, (each,), quest.seed), one_more) for each in found]
            good = [o for o in led if o.done or nearly_at_floor(o.current, o.data)]
            way = min(
                good, key=lambda o: (not o.done, o.current.hypothesis.size, o.current.judged), default=way
            )
    return way


def _in_its_place(stage: Stage, way: Way, quest: Quest) -> tuple[Stage, ...]:
    """Stages with another cause each in place of one, all others kept, best first."""
    current, data = way.current, way.data
    keys = [
        key for key, left in stage.behind if left < POLICY.replacement_close and not has_cause(current, key)
    ]
    if not keys or all(a.key != stage.added for a in current.hypothesis.free):
        return ()
    quest.progress(f"trying others in place of {stage.added}")
    (rest,) = fit([current.hypothesis.without(stage.added)], data, iterations=1)
    if rest is None:
        return ()
    scene = Scene.of(rest.hypothesis.model, data, rest.simulated, len(data.recordings))
    known = (
        *candidates(scene, rest, data, quest.seed),
        *what_gives_way(scene, data.training, rest.judged, rest.hypothesis.free),
    )
    chosen = [c for key in keys for c in known if c.key == key][: POLICY.replacements]
    fits = fit([with_candidate(scene, c, rest) for c in chosen], data)
    tried = [(c, f) for c, f in zip(chosen, fits, strict=True) if f is not None and witnessed(scene, f)]
    tried.sort(key=lambda cf: cf[1].judged)
    left = [*((c.key, f.judged) for c, f in tried), (stage.added, current.judged)]
    return tuple(_stage(explanation, left, stage, rest, way) for explanation in tried)


def _stage(explanation: Explanation, left: Sequence[Judged], stage: Stage, rest: Fit, way: Way) -> Stage:
    """One cause in place of another; `left`: what each of these leaves."""
    (candidate, found), data = explanation, way.data
    found = polished(found, data)
    floor = floor_of_judging(data)
    alike = [key for key, judged in left if judged <= found.judged * (1.0 + POLICY.tie)]
    pins = pins_of(way.current.hypothesis.base, candidate.key)
    return Stage(
        added=candidate.key,
        fit=found,
        data=data,
        removed_share=removed_share(rest.judged, found.judged, floor),
        rivals=tuple(dict.fromkeys(key for key in (*alike, *pins) if key != candidate.key)),
        others=(),
        dropped=(stage.added,),
        ranking=removed_shares(rest.judged, left, floor),
        behind=behind(candidate.key, found.judged, left),
        folds=(int(np.sum(found.agreeing < way.current.agreeing)), len(found.agreeing)),
        by_held_out=data.held_out_judges,
    )
