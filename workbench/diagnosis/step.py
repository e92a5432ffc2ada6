"""One step of the search: which effect to add now."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named

from .beside import named_beside, special_case
from .choosing import choose, margin
from .data import Data
from .fit import fit, race
from .giving import pins_of, what_gives_way
from .hypothesis import Fit
from .judging import (
    HELPS,
    LATER_SHARE,
    cancels,
    explains_fitted,
    floor_of_judging,
    helps,
    lowers_error,
    reached,
    witnessed,
)
from .refining import polished, prune, settle, with_candidate
from .screen import Candidate
from .sensitivity import Scene
from .stage import Stage

# What the rest must be above, in floors, for springs and gaps to be looked for: after a first effect, more.
_MOST_OF_IT = 1.5
_ALL_OF_IT = 1.04  # judged error over the noise's, below which nothing more is looked for
_WORTH = 3.0  # times what the best rigid explanation leaves: more is not worth a simulation
_CLOSE = 1.5  # times what the best leaves: where how friction sets in may decide
_SIMPLE, _REFINED = 5, 4  # candidates of each tier that are simulated

Progress = Callable[[str], None]


def next_stage(
    scene: Scene,
    candidates: Sequence[Candidate],
    current: Fit,
    data: Data,
    progress: Progress,
    *,
    later: bool = False,
    bold: bool = False,
) -> Stage | None:
    """The effect to add now, or None where nothing helps.

    What the model file itself states (its drives' inertia behind the transmission, a linkage that was
    identified) has no free parameter and cannot overfit: it comes first. Then basic effects, then
    refinements, unless simpler ones have reached the noise.

    Boldly, an effect is taken that explains most of what was fitted, whatever the folds say: causes that are
    still missing may set them against it. Only what such a step leads to can justify it.
    """
    floor = floor_of_judging(data)
    excess = max(current.judged - floor, 1e-12)
    fitted = {a.key for a in current.hypothesis.free}
    candidates = [c for c in candidates if c.key not in fitted]
    stated = [c for c in candidates if effect_named(c.key.effect).free(scene.model) == 0 and not c.shape]
    needed = 0.5 * (LATER_SHARE if later else HELPS) * excess
    free = [c for c in candidates if c not in stated and c.judged < current.judged - needed]
    # a first estimate leaves what the linearisation misses; only clear losers go unsimulated
    best_left = max(min((c.judged for c in free), default=0.0) - floor, 0.0)
    free = [c for c in free if c.judged - floor <= 10.0 * best_left + 0.05 * excess]
    tiers = [[c for c in free if effect_named(c.key.effect).tier == t] for t in (0, 1)]
    fits: list[tuple[Candidate, Fit]] = []
    removed: dict[EffectKey, float] = {}
    for tier, most in ((stated, len(stated)), (tiers[0], _SIMPLE), (tiers[1], _REFINED)):
        chosen = tier[:most]
        done = any(reached(f, data) for _, f in fits)
        settled = tier is tiers[1] and any(c in stated for c, f in fits if helps(f, current, excess))
        if not chosen or done or settled:
            continue
        own, behind = _fitted(scene, chosen, current, data, progress)
        removed |= behind
        # how friction sets in matters where the choice is made, not for those that are far behind
        fits += [
            (c, settle(f, data, floor) if f.trained < _CLOSE * own[0][1].trained else f) for c, f in own[:2]
        ]
        fits += own[2:]
    structural = any(c in stated for c, f in fits if helps(f, current, excess))
    full = _MOST_OF_IT if later else _ALL_OF_IT
    if not structural and not any(reached(f, data, full) for _, f in fits):
        # dear to simulate, and hardly ever asked for where all is rigid
        progress("looking for springs and gaps")
        best = min((f.judged for _, f in fits), default=np.inf)
        late = what_gives_way(scene, data.training, current.judged)
        late = [c for c in late if c.judged < _WORTH * best]
        if late:
            own, behind = _fitted(scene, late, current, data, progress)
            fits, removed = [*fits, *own], removed | behind
    enough = explains_fitted if bold else helps
    helpful = [(c, f) for c, f in fits if enough(f, current, excess) and lowers_error(f, current, data)]
    helpful = [(c, f) for c, f in helpful if witnessed(scene, f)]
    if not helpful:
        return None
    candidate, found, rivals = choose(helpful, stated, current.judged, data, scene.model)
    candidate, found = special_case(scene, candidate, found, helpful, data)
    wider = named_beside(scene, candidates, candidate, found, current, data)
    rivals = (*rivals, *(c.key for c, _ in wider))
    kept, dropped = prune(found, candidate.key, data, current)
    kept = polished(kept, data)
    if cancels(scene, kept):
        return None
    removed |= {c.key: (current.judged - f.judged) / excess for c, f in fits}
    ranking = sorted(removed.items(), key=lambda r: -r[1])
    left = {a.key for a in kept.hypothesis.added}
    twins = effect_named(candidate.key.effect).twins
    same = tuple(
        replace(candidate.key, effect=name) for name in twins if candidate.key.location == "actuator"
    )
    same += pins_of(scene.model, candidate.key)
    rivals = (*rivals, *(k for k in same if k not in rivals))
    return Stage(
        added=candidate.key,
        fit=kept,
        data=data,
        removed_share=(current.judged - kept.judged) / excess,
        rivals=(*rivals, *(k for k in dropped if not contains(candidate.key, k))),
        others=tuple(
            (c.key, f.hypothesis.model)
            for c, f in sorted([*helpful, *wider], key=lambda cf: cf[1].judged)
            if c is not candidate
            and (c.key in rivals or not contains(c.key, candidate.key))
            and not contains(candidate.key, c.key)
        ),
        dropped=tuple(a.key for a in current.hypothesis.added if a.key not in left),
        ranking=tuple(ranking),
        margin=margin(candidate, found, fits),
        folds=(int(np.sum(kept.agreeing < current.agreeing)), len(kept.agreeing)),
        by_held_out=data.held_out_judges,
    )


def _fitted(
    scene: Scene, chosen: Sequence[Candidate], current: Fit, data: Data, progress: Progress
) -> tuple[list[tuple[Candidate, Fit]], dict[EffectKey, float]]:
    """Candidates with their fits, best first, and what those removed of the excess that fell behind.

    What does not run is left out.
    """
    progress(f"fitting {', '.join(str(c.key) for c in chosen)}")
    pairs: list[tuple[Candidate, Fit]] = []
    behind: dict[EffectKey, float] = {}
    for wanders in (False, True):
        part = [c for c in chosen if effect_named(c.key.effect).wanders is wanders]
        if not part:
            continue
        tried = [with_candidate(scene, c, current) for c in part]
        results, shares = (fit(tried, data, 1), [None] * len(part)) if wanders else race(tried, current, data)
        pairs += [(c, f) for c, f in zip(part, results, strict=True) if f is not None]
        behind |= {c.key: x for c, x in zip(part, shares, strict=True) if x is not None}
    return sorted(pairs, key=lambda cf: cf[1].trained), behind
