"""Forward selection of effects with removal, judged on data that were not fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.comparison import Scale, Simulated, normalised, simulate_with_noise
from workbench.comparison.compare import consistent
from workbench.core import EffectKey, Recording
from workbench.effects import contains, effect_named
from workbench.models import AppliedEffect, Model, structural_effect

from .data import Data, floor_of, gather
from .fit import PRECISE, Fit, Hypothesis, applied_effect, fit, values_of, widened
from .screen import Candidate, screen
from .sensitivity import Column, Scene, combine

LIMIT = 6  # effects in a row; data that need more need a better model first
HELPS = 0.05  # share of the excess that an effect must remove on data it was not fitted on
# A later effect must also lower the whole error by this much, fitted and judged, where a fiftieth of the
# error at the start counts as nothing: what a first effect leaves is its own shape as often as a second one.
_LATER = 0.05
_LATER_TOLERANCE = 0.02
SLIDING = (0.0005, 0.003, 0.01, 0.03)  # rad/s
TIE = 0.03  # relative difference of judged error below which two explanations are one
AT_FLOOR = 1.25  # judged error over the noise's, below which the noise explains the rest
_CANCELLING = 5.0  # torques of all effects, each by itself, over that of their sum
_BASIC = 0.75  # share of the best candidate's gain with which inertia, damping and Coulomb friction go first
_SIMPLE, _REFINED = 5, 4  # candidates of each tier that are simulated

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Stage:
    """One accepted effect.

    Attributes:
        added: the effect.
        fit: model with it and all earlier ones, refitted.
        data: recordings with the noise floor of that model.
        before, after: judged error over the noise floor's.
        removed_share: share of the judged excess that it removed.
        rivals: effects that do as well, with the number of free parameters no smaller.
        dropped: earlier effects that it made needless.
        ranking: what every simulated candidate removed of the excess, best first.
        margin: judged error of the best other explanation over this one's; infinite where there is none.
        folds: (agreeing, all).
        runs: the model's runs, without and with noise; filled in when the stage is accepted.
    """

    added: EffectKey
    fit: Fit
    data: Data
    before: float
    after: float
    removed_share: float
    rivals: tuple[EffectKey, ...]
    dropped: tuple[EffectKey, ...]
    ranking: tuple[tuple[EffectKey, float], ...]
    margin: float
    folds: tuple[int, int]
    runs: Simulated | None = None


@dataclass(frozen=True)
class Search:
    """The whole way: data and fit at the start, stages, first screening, whether noise explains the end."""

    model: Model
    start: Fit
    start_data: Data
    start_runs: Simulated
    stages: tuple[Stage, ...]
    screened: tuple[Candidate, ...]
    consistent_before: bool
    consistent_after: bool
    explained: float

    @property
    def final(self) -> Fit:
        """The last accepted fit."""
        return self.stages[-1].fit if self.stages else self.start

    @property
    def final_data(self) -> Data:
        """The recordings with the floor of the last accepted model."""
        return self.stages[-1].data if self.stages else self.start_data


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
    survey: bool = False,
    progress: Progress = lambda text: None,
) -> Search:
    """Add effects one at a time until noise explains the rest or nothing helps.

    Args:
        model: where to start.
        training: recordings for fitting.
        held_out: recordings for judging; without them folds of the training data judge.
        seed: of the noise simulations.
        limit: most effects to add.
        survey: screen effects even where noise explains everything, to know what the data could show.
        progress: told what is being done.
    """
    progress("simulating the model and its noise")
    data, simulated = gather(model, training, held_out, seed)
    start = _start(model, data, simulated.clean)
    first = data
    before = is_consistent(data, start.mean_squares)
    current, stages, screened, done = start, [], (), before
    if before and survey:
        scene = Scene.of(model, data, start.simulated, len(data.recordings))
        screened = tuple(screen(scene, data, start.simulated, ())[0])
    while not done and len(stages) < limit and not (stages and _as_good_as_done(current, start, data)):
        progress(f"screening effects, step {len(stages) + 1}")
        scene = Scene.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
        candidates, _ = screen(scene, data, current.simulated, current.hypothesis.free)
        screened = screened or tuple(candidates)
        stage = _next(scene, candidates, current, data, progress)
        if stage is None:
            break
        costless = any(a.key == stage.added for a in stage.fit.hypothesis.stated)
        if stages and not costless and not _helps_later(stage.fit, current, start, data):
            break
        progress(f"found {stage.added}; simulating the noise")
        fresh, runs = _refloor(stage.fit, data, seed)
        stages.append(replace(stage, data=fresh, runs=runs))
        current = _rejudged(stage.fit, fresh)
        data, done = fresh, is_consistent(fresh, current.mean_squares)
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
        _explained(first, start, current),
    )


def _start(model: Model, data: Data, simulated: Sequence[Recording]) -> Fit:
    return _rejudged(
        Fit(Hypothesis(model, ()), tuple(simulated), data.mean_squares(simulated), 0.0, 0.0, np.zeros(0)),
        data,
    )


def _rejudged(old: Fit, data: Data) -> Fit:
    """The same fit under new weights; its parameters stay, so folds are judged as they are."""
    trained = data.objective(data.pool(old.mean_squares))
    if data.training < len(data.recordings):
        folds = np.array([data.objective(ms) for ms in old.mean_squares[data.training :]])
        judged = data.objective(data.pool(old.mean_squares, held_out=True))
    else:
        folds = np.array(
            [
                np.mean(
                    np.sum(
                        (data.residual(f.recording, old.simulated[f.recording])[f.rows] * data.weight) ** 2,
                        (1, 2),
                    )
                )
                for f in data.folds
            ]
        )
        judged = trained
    return replace(old, trained=trained, judged=judged, agreeing=folds)


def _floor(data: Data) -> float:
    """Judged error that a perfect model would have."""
    return data.objective(data.pool(data.floor, held_out=data.training < len(data.recordings)))


def _refloor(found: Fit, data: Data, seed: int) -> tuple[Data, Simulated]:
    simulated = simulate_with_noise(found.hypothesis.model, data.recordings, seed=seed, noise=data.noise)
    fresh = floor_of(data.recordings, data.training, simulated)
    return fresh.reweighed(found.mean_squares), simulated


def _explained(data: Data, start: Fit, end: Fit) -> float:
    """Share of the excess at the start that is gone at the end, of fitted or held-out data, the smaller."""
    shares = []
    for held_out in {False, data.training < len(data.recordings)}:
        floor = data.pool(data.floor, held_out)
        first, last = data.pool(start.mean_squares, held_out), data.pool(end.mean_squares, held_out)
        before = data.objective(np.maximum(first - floor, 0.0))
        after = data.objective(np.maximum(last - 1.03 * floor, 0.0))
        shares.append(float(np.clip(1.0 - after / before, 0.0, 1.0)) if before > 0 else 0.0)
    return min(shares)


def _next(
    scene: Scene, candidates: Sequence[Candidate], current: Fit, data: Data, progress: Progress
) -> Stage | None:
    """The effect to add now, or None where nothing helps.

    What the model file itself states (its drives' inertia behind the transmission, a linkage that was
    identified) has no free parameter and cannot overfit: it comes first. Then basic effects, then
    refinements, unless simpler ones have reached the noise.
    """
    floor = _floor(data)
    excess = max(current.judged - floor, 1e-12)
    fitted = {a.key for a in current.hypothesis.free}
    candidates = [c for c in candidates if c.key not in fitted]
    stated = [c for c in candidates if effect_named(c.key.effect).free(scene.model) == 0 and not c.shape]
    free = [c for c in candidates if c not in stated and c.judged < current.judged - 0.5 * HELPS * excess]
    # a first estimate leaves what the linearisation misses; only clear losers go unsimulated
    best_left = max(min((c.judged for c in free), default=0.0) - floor, 0.0)
    free = [c for c in free if c.judged - floor <= 10.0 * best_left + 0.05 * excess]
    tiers = [[c for c in free if effect_named(c.key.effect).tier == t] for t in (0, 1)]
    fits: list[tuple[Candidate, Fit]] = []
    for tier, most in ((stated, len(stated)), (tiers[0], _SIMPLE), (tiers[1], _REFINED)):
        chosen = tier[:most]
        reached = any(f.judged < AT_FLOOR * floor for _, f in fits)
        settled = tier is tiers[1] and any(c in stated for c, f in fits if _helps(f, current, excess))
        if not chosen or reached or settled:
            continue
        progress(f"fitting {', '.join(str(c.key) for c in chosen)}")
        results = fit([_hypothesis(scene, c, current) for c in chosen], data)
        own = sorted(
            ((c, f) for c, f in zip(chosen, results, strict=True) if f is not None),
            key=lambda cf: cf[1].trained,
        )
        # how friction sets in matters where the choice is made, not for those that are far behind
        fits += [
            (c, settle(f, data, floor) if f.trained < 1.5 * own[0][1].trained else f) for c, f in own[:2]
        ]
        fits += own[2:]
    helpful = [(c, f) for c, f in fits if _helps(f, current, excess) and _lowers_error(f, current, data)]
    if not helpful:
        return None
    candidate, found, rivals = _choose(helpful, stated, current.judged, floor, scene.model)
    kept, dropped = _prune(found, candidate.key, data, current)
    kept = _polished(kept, data)
    if _cancels(scene, kept):
        return None
    ranking = sorted(((c.key, (current.judged - f.judged) / excess) for c, f in fits), key=lambda r: -r[1])
    left = {a.key for a in kept.hypothesis.added}
    twins = effect_named(candidate.key.effect).twins
    same = tuple(
        replace(candidate.key, effect=name) for name in twins if candidate.key.location == "actuator"
    )
    rivals = (*rivals, *(k for k in same if k not in rivals))
    return Stage(
        added=candidate.key,
        fit=kept,
        data=data,
        before=current.judged / floor,
        after=kept.judged / floor,
        removed_share=(current.judged - kept.judged) / excess,
        rivals=(*rivals, *(k for k in dropped if not contains(candidate.key, k))),
        dropped=tuple(a.key for a in current.hypothesis.added if a.key not in left),
        ranking=tuple(ranking),
        margin=_margin(candidate, found, fits),
        folds=(int(np.sum(kept.agreeing < current.agreeing)), len(kept.agreeing)),
    )


def _cancels(scene: Scene, found: Fit) -> bool:
    """Whether effects mostly undo each other: two smooth curves that mimic a third, not two causes."""
    totals = [scene.total(a, a.values) for a in found.hypothesis.free]
    if len(totals) < 2:
        return False

    def size(column: Column) -> float:
        return float(np.sqrt(sum(np.sum(t**2) for t in column.torque)))

    return sum(map(size, totals)) > _CANCELLING * size(combine(totals, [1.0] * len(totals)))


def _polished(found: Fit, data: Data) -> Fit:
    """The same effects with their parameters to the last digit that noise leaves."""
    if not found.hypothesis.free:
        return found
    better = fit([found.hypothesis], data, iterations=4, enough=PRECISE)[0]
    return found if better is None or better.trained > found.trained else widened(better, [found], share=0.0)


def settle(found: Fit, data: Data, floor: float) -> Fit:
    """Let the data say how dry friction sets in, where the rest could be due to that.

    The sliding speed is a property of the contact that no catalogue lists. A grid finds it; how far the
    parameters move from one grid point to the next is what its shape leaves open, and widens intervals.
    """
    dry = any(effect_named(a.key.effect).dry for a in found.hypothesis.free)
    if not dry or found.trained < 1.03 * floor or found.trained > 50.0 * floor:
        return found

    def at(speed: float) -> Hypothesis:
        return replace(found.hypothesis, base=replace(found.hypothesis.base, sliding_speed=speed))

    best = int(np.argmin(values_of([at(speed) for speed in SLIDING], data)))
    around = [k for k in (best - 1, best, best + 1) if 0 <= k < len(SLIDING)]
    fits = [f for f in fit([at(SLIDING[k]) for k in around], data, iterations=2) if f is not None]
    if not fits:
        return found
    chosen = min(fits, key=lambda f: f.trained)
    return widened(chosen, fits) if chosen.trained < found.trained else found


def _as_good_as_done(current: Fit, start: Fit, data: Data) -> bool:
    """Whether even a perfect further effect could not lower the whole error by enough."""
    plain = data.reweighed(start.mean_squares, _LATER_TOLERANCE)
    floor, now = plain.pool(plain.floor), plain.pool(current.mean_squares)
    return bool(np.sqrt(plain.objective(floor)) > (1.0 - _LATER) * np.sqrt(plain.objective(now)))


def _helps_later(found: Fit, current: Fit, start: Fit, data: Data) -> bool:
    """Whether an effect after the first lowers the whole error, not only what the first left of its own."""
    plain = data.reweighed(start.mean_squares, _LATER_TOLERANCE)
    for held_out in {False, data.training < len(data.recordings)}:
        before = plain.objective(plain.pool(current.mean_squares, held_out))
        after = plain.objective(plain.pool(found.mean_squares, held_out))
        if np.sqrt(after) > (1.0 - _LATER) * np.sqrt(before):
            return False
    return True


def _helps(found: Fit, current: Fit, excess: float) -> bool:
    """Whether a fit is better on what it was not fitted on, by enough and on most folds."""
    agree = np.mean(found.agreeing < current.agreeing)
    return bool(current.judged - found.judged > HELPS * excess and agree > 0.5)


def _margin(chosen: Candidate, found: Fit, fits: Sequence[tuple[Candidate, Fit]]) -> float:
    """How much worse the best other explanation is, leaving out those that contain this one."""
    others = [
        f.judged
        for c, f in fits
        if c is not chosen and not contains(c.key, chosen.key) and not contains(chosen.key, c.key)
    ]
    return min(others, default=float("inf")) / max(found.judged, 1e-12)


def _lowers_error(found: Fit, current: Fit, data: Data) -> bool:
    """Whether the reported error falls, on what was fitted and on what was not."""
    parts = {False, data.training < len(data.recordings)}
    return all(data.score(found.mean_squares, p) < data.score(current.mean_squares, p) for p in parts)


def _choose(
    helpful: list[tuple[Candidate, Fit]],
    stated: Sequence[Candidate],
    before: float,
    floor: float,
    model: Model,
) -> tuple[Candidate, Fit, tuple[EffectKey, ...]]:
    """The best explanation; of those as good, the one with fewest free parameters, and its rivals."""

    def cost(c: Candidate) -> tuple[int, int]:
        effect = effect_named(c.key.effect)
        return effect.free(model), effect.tier

    known = [(c, f) for c, f in helpful if c in stated]
    reached = [(c, f) for c, f in helpful if f.judged < AT_FLOOR * floor]
    most = min(f.judged for _, f in helpful)
    basic = [
        (c, f)
        for c, f in helpful
        if effect_named(c.key.effect).basic and before - f.judged > _BASIC * (before - most)
    ]
    pool = known or reached or basic or helpful
    best = min(f.judged for _, f in pool)
    ties = [(c, f) for c, f in pool if f.judged <= best * (1.0 + TIE)]
    ties.sort(key=lambda cf: (cost(cf[0]), cf[1].judged))
    candidate, found = ties[0]
    # whatever does as well is a rival, wherever it came from, unless it merely contains the choice
    rivals = tuple(
        c.key
        for c, f in sorted(helpful, key=lambda cf: cf[1].judged)
        if c is not candidate
        and f.judged <= found.judged * (1.0 + TIE)
        and not contains(c.key, candidate.key)
        and c not in stated
    )
    return candidate, found, rivals


def _hypothesis(scene: Scene, candidate: Candidate, current: Fit) -> Hypothesis:
    """The current model with a candidate; effects that it contains in the same place make room for it."""
    effect = effect_named(candidate.key.effect)
    base, free = current.hypothesis.base, current.hypothesis.free

    if effect.free(scene.model) == 0:
        added = structural_effect(effect.name, scene.model.linkage)
        return Hypothesis(base, free, (*current.hypothesis.stated, added))
    coefficients, shape = candidate.coefficients, candidate.shape
    given_up = [a for a in free if contains(candidate.key, a.key)]
    if given_up:
        linear, _ = scene.columns(candidate.key, shape)
        target = combine(
            [*linear, *(scene.total(a, a.values) for a in given_up)],
            [*coefficients, *(1.0 for _ in given_up)],
        )
        x = np.stack([np.concatenate([t.ravel() for t in c.torque]) for c in linear], axis=1)
        y = np.concatenate([t.ravel() for t in target.torque])
        coefficients = np.linalg.lstsq(x, y, rcond=None)[0]
        lower = np.array([p.lower for p in effect.parameters if p.name not in effect.nonlinear])
        coefficients = np.maximum(coefficients, lower)
    values = effect.to_parameters(coefficients, shape)
    added = applied_effect(scene.model, AppliedEffect(candidate.key), values)
    return Hypothesis(base, (*(a for a in free if a not in given_up), added), current.hypothesis.stated)


def _prune(found: Fit, added: EffectKey, data: Data, current: Fit) -> tuple[Fit, tuple[EffectKey, ...]]:
    """Drop effects that the new one made needless, as long as judging does not suffer."""
    dropped: tuple[EffectKey, ...] = ()
    while True:
        rest = [a for a in found.hypothesis.free if a.key != added]
        if not rest:
            return found, dropped
        trials = [
            replace(found.hypothesis, free=tuple(b for b in found.hypothesis.free if b.key != a.key))
            for a in rest
        ]
        fits = fit(trials, data, iterations=3)
        options = [(f.judged, a.key, f) for a, f in zip(rest, fits, strict=True) if f is not None]
        options = [o for o in options if o[0] <= found.judged * (1.0 + 0.3 * TIE) and o[0] < current.judged]
        if not options:
            return found, dropped
        _, key, found = min(options, key=lambda o: o[0])
        dropped = (*dropped, key)
