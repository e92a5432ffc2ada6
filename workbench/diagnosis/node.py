"""The way of a search: one effect after the other, each with its own noise."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.comparison import Scale, Simulated, normalised
from workbench.comparison.consistent import consistent
from workbench.core import EffectKey, SimulationError
from workbench.effects import effect_named

from .acceptance import as_good_as_done, helps_later, overshadowed, unseen_on_held_out
from .data import Data
from .fitting.divergence import parting
from .hypothesis import Fit
from .loss import explained, mostly_explained, rejudged
from .moves.add import next_stage
from .policy import POLICY
from .problem import Quest
from .screening.screen import Candidate, screen
from .screening.sensitivity import Scene
from .screening.stiction import candidates
from .search_result import Stage

Keys = frozenset[EffectKey]


@dataclass(frozen=True)
class Way:
    """Where a search stands: the fit, the data with its noise, how it came there, whether noise is left."""

    current: Fit
    data: Data
    stages: tuple[Stage, ...] = ()
    done: bool = False


def onwards(
    way: Way,
    quest: Quest,
    *,
    through: bool = False,
    basics_first: bool = True,
    met: Collection[Keys] = (),
) -> Way:
    """One effect after the other from where the search stands.

    `through`: also where runs part by themselves; by how much they do is asked at the end.
    `basics_first`: inertia, damping and Coulomb friction before others that explain somewhat more.
    `met`: sets of effects from which the way on is known; it ends there.
    """
    take = partial(next_stage, progress=quest.progress, basics_first=basics_first)
    current, data, stages, done = way.current, way.data, list(way.stages), way.done
    start, progress = quest.start, quest.progress
    most = len(stages) + quest.limit
    while not done and len(stages) < most and not (stages and as_good_as_done(current, start, data)):
        if keys_of(current) in met or data.effort.spent:
            break
        progress(f"screening effects, step {len(stages) + 1}")
        scene, screened = screened_at(current, data, quest) if stages else (quest.scene, quest.screened)
        stage = take(scene, screened, current, data, later=bool(stages))
        if stage is None and overshadowed(current, data):
            # held-out motion may never reach what is lacking, a limit for one
            progress("judging by the recordings that show most")
            deaf = data.unheard()
            screened, _ = screen(scene, deaf, current.simulated, current.hypothesis.free)
            stage = take(scene, screened, rejudged(current, deaf), deaf, later=bool(stages))
            if stage is not None and not unseen_on_held_out(stage.fit, current, data):
                stage = None
        if stage is None:
            break
        costless = any(a.key == stage.added for a in stage.fit.hypothesis.stated)
        if stages and not costless and not helps_later(stage.fit, current, start, stage.data):
            break
        progress(f"found {stage.added}; simulating the noise")
        fresh, runs = _refloor(stage.fit, data, quest.seed, wide=not through)
        stages.append(replace(stage, data=fresh, runs=runs))
        current = rejudged(stage.fit, fresh)
        # what is left of runs that part by themselves says nothing of a further effect
        data, done = fresh, is_consistent(fresh, current.mean_squares)
        if wanders(current) and not through:
            break
    return Way(current, data, tuple(stages), done)


def keys_of(found: Fit) -> Keys:
    """Its effects."""
    return frozenset(a.key for a in found.hypothesis.added)


def screened_at(current: Fit, data: Data, quest: Quest) -> tuple[Scene, Sequence[Candidate]]:
    """The loops linearised about where the search stands, and every effect screened there."""
    scene = scene_at(current, data, quest)
    return scene, candidates(scene, current, data, quest.seed)


def scene_at(current: Fit, data: Data, quest: Quest) -> Scene:
    """The loops linearised about where the search stands; the same where another way comes back to it."""
    if not current.hypothesis.added:
        return quest.scene
    for scene in quest.scenes:
        if all(a is b for a, b in zip(scene.runs, current.simulated, strict=True)):
            return scene
    scene = Scene.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
    quest.scenes.appendleft(scene)
    return scene


def after(stages: tuple[Stage, ...], quest: Quest) -> Way:
    """Where a search stood after its first stages, or before any."""
    if not stages:
        return Way(quest.start, quest.data)
    data = stages[-1].data
    return Way(rejudged(stages[-1].fit, data), data, stages)


def holds(way: Way, quest: Quest) -> bool:
    """Whether what was found explains the data."""
    if way.done or not way.stages:
        return way.done
    ends = quest.data, quest.start, way.current, way.data
    shares = [explained(*ends), mostly_explained(*ends) if wanders(way.current) else 0.0]
    return max(shares) >= POLICY.explained


def with_stages(way: Way, found: Sequence[Stage], seed: int, *, wide: bool = True) -> Way:
    """The search after further stages, each with the noise of its own model."""
    data, stages = way.data, list(way.stages)
    for stage in found:
        data, runs = _refloor(stage.fit, data, seed, wide=wide)
        stages.append(replace(stage, data=data, runs=runs))
    current = rejudged(stages[-1].fit, data)
    return Way(current, data, tuple(stages), is_consistent(data, current.mean_squares))


def with_last(way: Way, last: Stage, seed: int) -> Way:
    """The search with another form of its last stage, and the noise of that."""
    return with_stages(replace(way, stages=way.stages[:-1]), (last,), seed)


def is_consistent(data: Data, mean_squares: np.ndarray, *, by_signal: bool = True) -> bool:
    """Whether the training error is no larger than noise makes it (and, `by_signal`, that of each signal)."""
    scale = Scale.of(data.recordings[: data.training])
    draws = np.stack([data.pool(np.stack([np.mean(x**2, axis=0) for x in draw])) for draw in data.draws])
    pooled = data.pool(mean_squares)
    error, floors = normalised(pooled, scale), np.array([normalised(d, scale) for d in draws])
    allowed = data.pool(data.immaterial)
    return consistent(pooled, draws, error, floors, allowed, by_signal=by_signal)


def wanders(found: Fit) -> bool:
    """Whether its runs part by themselves."""
    return any(effect_named(a.key.effect).wanders for a in found.hypothesis.free)


def _refloor(found: Fit, data: Data, seed: int, *, wide: bool = True) -> tuple[Data, Simulated | None]:
    """The noise of a model's own runs; `wide`: and how far these part by themselves.

    Where noise is more than its loop stands, it is judged by the noise of the model before, and has no runs.
    """
    try:
        fresh, simulated = data.of_model(found.hypothesis.model, seed)
    except SimulationError:
        return data.reweighed(found.mean_squares).heard(found.mean_squares), None
    if wide and wanders(found):
        fresh = replace(fresh, floor=np.maximum(fresh.floor, parting(found, data)))
    return fresh.reweighed(found.mean_squares).heard(found.mean_squares), simulated
