"""Forward selection of effects with removal, judged on data that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.comparison import Scale, Simulated, normalised
from workbench.comparison.compare import consistent
from workbench.core import HOPELESS, Recording, SimulationError
from workbench.effects import effect_named
from workbench.models import Model

from .data import Data, floor_of, gather
from .hypothesis import Fit, Hypothesis
from .judging import (
    EXPLAINED,
    as_good_as_done,
    explained,
    helps_later,
    mostly_explained,
    nearly_at_floor,
    overshadowed,
    rejudged,
    unseen_on_held_out,
)
from .pairs import two_at_once
from .parting import parting
from .screen import Candidate, screen
from .sensitivity import Scene
from .simpler import simpler
from .stage import Search, Stage
from .step import Progress, next_stage

LIMIT = 6  # effects in a row; data that need more need a better model first


@dataclass(frozen=True)
class _Way:
    """Where the search stands: the fit, the data with its noise, how it came there, whether noise is left."""

    current: Fit
    data: Data
    stages: tuple[Stage, ...] = ()
    done: bool = False


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

    Where that leaves the data unexplained there are other ways to begin, of which more is asked in the end:
    by what the training recordings show, where held-out motion shows little; and with two effects at once,
    since the best first step of a pair may be neither of them.

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
    scene = Scene.of(model, data, start.simulated, len(data.recordings))
    first, before = data, is_consistent(data, start.mean_squares)
    screened = tuple(screen(scene, data, start.simulated, ())[0])
    way = _Way(start, data, done=before)
    if not before:
        way = _onwards(way, scene, screened, start, limit, seed, progress)
        if not _holds(way, first, start) and limit > 1:
            for begin in (_by_training, two_at_once):
                stages = begin(scene, data, start, progress)
                other = _taken(stages, start, data, seed) if stages else way
                if stages and not nearly_at_floor(other.current, other.data):
                    other = _onwards(other, scene, screened, start, limit, seed, progress)
                sure = other.done or nearly_at_floor(other.current, other.data)
                if stages and sure and _holds(other, first, start):
                    way = other
                    break
    way = _simplified(way, seed, progress)
    current, data = way.current, way.data
    # a signal that is a little off after all that could be found is no sign of one more effect
    done = way.done or (len(way.stages) > 0 and is_consistent(data, current.mean_squares, by_signal=False))
    return Search(
        model,
        start,
        first,
        simulated,
        way.stages,
        screened,
        before,
        done,
        explained(first, start, current, data),
        mostly_explained(first, start, current, data) if _wanders(current) else 0.0,
    )


def _onwards(
    way: _Way,
    scene: Scene,
    screened: Sequence[Candidate],
    start: Fit,
    limit: int,
    seed: int,
    progress: Progress,
) -> _Way:
    """One effect after the other from where the search stands; `scene` and `screened` are of its start."""
    current, data, stages, done = way.current, way.data, list(way.stages), way.done
    while not done and len(stages) < limit and not (stages and as_good_as_done(current, start, data)):
        progress(f"screening effects, step {len(stages) + 1}")
        candidates = screened
        if stages:
            scene = Scene.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
            candidates = screen(scene, data, current.simulated, current.hypothesis.free)[0]
        stage = next_stage(scene, candidates, current, data, progress, later=bool(stages))
        if stage is None and overshadowed(current, data):
            # held-out motion may never reach what is lacking, a limit for one
            progress("judging by the recordings that show most")
            deaf = data.unheard()
            candidates, _ = screen(scene, deaf, current.simulated, current.hypothesis.free)
            stage = next_stage(scene, candidates, rejudged(current, deaf), deaf, progress, later=bool(stages))
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
    return _Way(current, data, tuple(stages), done)


def _by_training(scene: Scene, data: Data, start: Fit, progress: Progress) -> tuple[Stage, ...]:
    """A first effect as the training recordings judge it, where they show much more than held-out motion."""
    if not overshadowed(start, data):
        return ()
    progress("beginning with what the training recordings show")
    deaf = data.unheard()
    candidates, _ = screen(scene, deaf, start.simulated, ())
    stage = next_stage(scene, candidates, rejudged(start, deaf), deaf, progress)
    return () if stage is None else (stage,)


def _holds(way: _Way, first: Data, start: Fit) -> bool:
    """Whether what was found explains the data."""
    if way.done or not way.stages:
        return way.done
    shares = [explained(first, start, way.current, way.data)]
    if _wanders(way.current):
        shares.append(mostly_explained(first, start, way.current, way.data))
    return max(shares) >= EXPLAINED


def _taken(pair: Sequence[Stage], start: Fit, data: Data, seed: int) -> _Way:
    """The search after two stages at once."""
    stages = []
    for stage in pair:
        data, runs = _refloor(stage.fit, data, seed)
        stages.append(replace(stage, data=data, runs=runs))
    current = rejudged(stages[-1].fit, data)
    return _Way(current, data, tuple(stages), is_consistent(data, current.mean_squares))


def _simplified(way: _Way, seed: int, progress: Progress) -> _Way:
    """Once all causes are there, a simpler form of an earlier one where it does as well."""
    for stage in way.stages[:-1]:
        simple = simpler(stage, way.current, way.data, progress)
        if simple is not None:
            data, runs = _refloor(simple.fit, way.data, seed)
            current = rejudged(simple.fit, data)
            stages = (*way.stages, replace(simple, data=data, runs=runs))
            way = _Way(current, data, stages, is_consistent(data, current.mean_squares))
    return way


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
