"""Forward selection of effects with removal, judged on data that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import Scale, Simulated, normalised
from workbench.comparison.compare import consistent
from workbench.core import HOPELESS, EffectKey, Recording, SimulationError
from workbench.effects import contains, effect_named
from workbench.models import Model

from .data import Data, floor_of, gather
from .fit import fit, race
from .giving import pins_of, what_gives_way
from .hypothesis import Fit, Hypothesis
from .judging import (
    AT_FLOOR,
    HELPS,
    LATER_SHARE,
    as_good_as_done,
    cancels,
    choose,
    explained,
    floor_of_judging,
    helps,
    helps_later,
    lowers_error,
    margin,
    mostly_explained,
    overshadowed,
    rejudged,
    unseen_on_held_out,
)
from .parting import parting
from .refining import polished, prune, settle, with_candidate
from .screen import Candidate, screen
from .sensitivity import Scene
from .simpler import Progress, simpler
from .stage import Search, Stage

LIMIT = 6  # effects in a row; data that need more need a better model first
# What the rest must be above, in floors, for springs and gaps to be looked for: after a first effect, more.
_MOST_OF_IT = 1.5
_ALL_OF_IT = 1.04  # judged error over the noise's, below which nothing more is looked for
_WORTH = 3.0  # times what the best rigid explanation leaves: more is not worth a simulation
_CLOSE = 1.5  # times what the best leaves: where how friction sets in may decide
_SIMPLE, _REFINED = 5, 4  # candidates of each tier that are simulated


def is_consistent(data: Data, mean_squares: np.ndarray, *, by_signal: bool = True) -> bool:
    """Whether the training error is no larger than noise makes it (and, `by_signal`, that of each signal)."""
    scale = Scale.of(data.recordings[: data.training])
    draws = np.stack([data.pool(np.stack([np.mean(x**2, axis=0) for x in draw])) for draw in data.draws])
    pooled = data.pool(mean_squares)
    floors = np.array([normalised(d, scale) for d in draws])
    return consistent(pooled, draws, normalised(pooled, scale), floors, by_signal=by_signal)


def search(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    *,
    seed: int = 0,
    limit: int = LIMIT,
    progress: Progress = lambda text: None,
) -> Search:
    """Add effects one at a time until noise explains the rest or nothing helps.

    Args:
        model: where to start.
        training: recordings for fitting.
        held_out: recordings for judging; without them, or where they show nothing of what is lacking,
            folds of the training data judge.
        seed: of the noise simulations.
        limit: most effects to add.
        progress: told what is being done.
    """
    progress("simulating the model and its noise")
    data, simulated = gather(model, training, held_out, seed)
    data = data.heard(data.mean_squares(simulated.clean))
    start = starting_fit(model, data, simulated.clean)
    if data.score(data.floor) > HOPELESS:
        raise SimulationError(
            f"model '{model.name}' cannot run these loops: noise alone throws it further off than all that "
            "was measured; check the order of the axes, units, signs and gains"
        )
    first = data
    before = is_consistent(data, start.mean_squares)
    current, stages, screened, done = start, [], (), before
    if before:  # what the data could have shown
        scene = Scene.of(model, data, start.simulated, len(data.recordings))
        screened = tuple(screen(scene, data, start.simulated, ())[0])
    while not done and len(stages) < limit and not (stages and as_good_as_done(current, start, data)):
        progress(f"screening effects, step {len(stages) + 1}")
        scene = Scene.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
        candidates, _ = screen(scene, data, current.simulated, current.hypothesis.free)
        screened = screened or tuple(candidates)
        stage = _next(scene, candidates, current, data, progress, later=bool(stages))
        if stage is None and overshadowed(current, data):
            # held-out motion may never reach what is lacking, a limit for one
            progress("judging by the recordings that show most")
            deaf = data.unheard()
            candidates, _ = screen(scene, deaf, current.simulated, current.hypothesis.free)
            stage = _next(scene, candidates, rejudged(current, deaf), deaf, progress, later=bool(stages))
            if stage is not None and not unseen_on_held_out(stage.fit, current, data):
                stage = None
        if stage is None:
            break
        costless = any(a.key == stage.added for a in stage.fit.hypothesis.stated)
        if stages and not costless and not helps_later(stage.fit, current, start, stage.data):
            break
        progress(f"found {stage.added}; simulating the noise")
        fresh, runs = _refloor(stage.fit, data, seed)
        stages.append(replace(stage, data=fresh, runs=runs))
        current = rejudged(stage.fit, fresh)
        # what is left of runs that part by themselves says nothing of a further effect
        data, done = fresh, is_consistent(fresh, current.mean_squares)
        if _wanders(current):
            break
    for stage in tuple(stages[:-1]):
        simple = simpler(stage, current, data, progress)
        if simple is not None:
            data, runs = _refloor(simple.fit, data, seed)
            stages.append(replace(simple, data=data, runs=runs))
            current = rejudged(simple.fit, data)
            done = is_consistent(data, current.mean_squares)
    # a signal that is a little off after all that could be found is no sign of one more effect
    done = done or (len(stages) > 0 and is_consistent(data, current.mean_squares, by_signal=False))
    return Search(
        model,
        start,
        first,
        simulated,
        tuple(stages),
        screened,
        before,
        done,
        explained(first, start, current, data),
        mostly_explained(first, start, current, data) if _wanders(current) else 0.0,
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


def starting_fit(model: Model, data: Data, simulated: Sequence[Recording]) -> Fit:
    """The model as it is, as a fit of nothing."""
    return rejudged(
        Fit(Hypothesis(model, ()), tuple(simulated), data.mean_squares(simulated), 0.0, 0.0, np.zeros(0)),
        data,
    )


def _wanders(found: Fit) -> bool:
    return any(effect_named(a.key.effect).wanders for a in found.hypothesis.free)


def _refloor(found: Fit, data: Data, seed: int) -> tuple[Data, Simulated]:
    simulated = data.replay.with_noise(found.hypothesis.model, seed)
    fresh = floor_of(data.replay, data.training, simulated)
    if _wanders(found):
        fresh = replace(fresh, floor=np.maximum(fresh.floor, parting(found, data)))
    return fresh.reweighed(found.mean_squares).heard(found.mean_squares), simulated


def _next(
    scene: Scene,
    candidates: Sequence[Candidate],
    current: Fit,
    data: Data,
    progress: Progress,
    *,
    later: bool = False,
) -> Stage | None:
    """The effect to add now, or None where nothing helps.

    What the model file itself states (its drives' inertia behind the transmission, a linkage that was
    identified) has no free parameter and cannot overfit: it comes first. Then basic effects, then
    refinements, unless simpler ones have reached the noise.
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
        reached = any(f.judged < AT_FLOOR * floor for _, f in fits)
        settled = tier is tiers[1] and any(c in stated for c, f in fits if helps(f, current, excess))
        if not chosen or reached or settled:
            continue
        own, behind = _fitted(scene, chosen, current, data, progress)
        removed |= behind
        # how friction sets in matters where the choice is made, not for those that are far behind
        fits += [
            (c, settle(f, data, floor) if f.trained < _CLOSE * own[0][1].trained else f) for c, f in own[:2]
        ]
        fits += own[2:]
    structural = any(c in stated for c, f in fits if helps(f, current, excess))
    enough = _MOST_OF_IT if later else _ALL_OF_IT
    if not structural and not any(f.judged < enough * floor for _, f in fits):
        # dear to simulate, and hardly ever asked for where all is rigid
        progress("looking for springs and gaps")
        best = min((f.judged for _, f in fits), default=np.inf)
        late = what_gives_way(scene, data.training, current.judged)
        late = [c for c in late if c.judged < _WORTH * best]
        if late:
            own, behind = _fitted(scene, late, current, data, progress)
            fits, removed = [*fits, *own], removed | behind
    helpful = [(c, f) for c, f in fits if helps(f, current, excess) and lowers_error(f, current, data)]
    if not helpful:
        return None
    candidate, found, rivals = choose(helpful, stated, current.judged, floor, scene.model)
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
            for c, f in sorted(helpful, key=lambda cf: cf[1].judged)
            if c is not candidate
            and not contains(c.key, candidate.key)
            and not contains(candidate.key, c.key)
        ),
        dropped=tuple(a.key for a in current.hypothesis.added if a.key not in left),
        ranking=tuple(ranking),
        margin=margin(candidate, found, fits),
        folds=(int(np.sum(kept.agreeing < current.agreeing)), len(kept.agreeing)),
        by_held_out=data.held_out_judges,
    )
