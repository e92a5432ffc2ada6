"""The ways of a search: one effect after the other, and how else to begin where that leads nowhere."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.comparison import Scale, Simulated, normalised
from workbench.comparison.compare import consistent
from workbench.core import EffectKey
from workbench.effects import effect_named

from .data import Data, floor_of
from .everywhere import on_every_axis
from .hypothesis import Fit
from .judging import (
    EXPLAINED,
    NEARLY_ALL,
    as_good_as_done,
    explained,
    helps_later,
    mostly_explained,
    nearly_at_floor,
    overshadowed,
    reached,
    rejudged,
    unseen_on_held_out,
)
from .pairs import two_at_once
from .parting import parting
from .screen import Candidate, screen
from .sensitivity import Scene
from .stage import Stage
from .step import next_stage
from .sticking import candidates
from .trying import Progress

Keys = frozenset[EffectKey]


@dataclass(frozen=True)
class Quest:
    """What is searched for and with what.

    Attributes:
        start: the model as it is.
        data: the recordings with its noise.
        scene: its linearised loops.
        screened: every effect in every place, as a first one.
        limit: most effects to add one by one.
        seed: of the noise simulations.
        progress: told what is being done.
    """

    start: Fit
    data: Data
    scene: Scene
    screened: tuple[Candidate, ...]
    limit: int
    seed: int
    progress: Progress


@dataclass(frozen=True)
class Way:
    """Where a search stands: the fit, the data with its noise, how it came there, whether noise is left."""

    current: Fit
    data: Data
    stages: tuple[Stage, ...] = ()
    done: bool = False


def onwards(way: Way, quest: Quest, *, through: bool = False, met: Collection[Keys] = ()) -> Way:
    """One effect after the other from where the search stands.

    `through`: also where runs part by themselves; by how much they do is asked at the end.
    `met`: sets of effects from which the way on is known; it ends there.
    """
    current, data, stages, done = way.current, way.data, list(way.stages), way.done
    start, progress = quest.start, quest.progress
    most = len(stages) + quest.limit
    while not done and len(stages) < most and not (stages and as_good_as_done(current, start, data)):
        if _keys(current) in met:
            break
        progress(f"screening effects, step {len(stages) + 1}")
        scene, screened = _screened(current, data, quest) if stages else (quest.scene, quest.screened)
        stage = next_stage(scene, screened, current, data, progress, later=bool(stages))
        if stage is None and overshadowed(current, data):
            # held-out motion may never reach what is lacking, a limit for one
            progress("judging by the recordings that show most")
            deaf = data.unheard()
            screened, _ = screen(scene, deaf, current.simulated, current.hypothesis.free)
            stage = next_stage(scene, screened, rejudged(current, deaf), deaf, progress, later=bool(stages))
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


def otherwise(way: Way, quest: Quest) -> Way:
    """The first of the other ways that leads to the noise; `way` where none does.

    By what the training recordings show, where held-out motion shows little; with the same cause on every
    axis, each of which has its share; with two effects at once, since the best first step of a pair may be
    neither of them; and boldly on from where the first way ended.
    """
    start, data = quest.start, quest.data
    met = [_keys(stage.fit) for stage in way.stages]
    beginnings = (
        (_by_training, _sure),
        (partial(on_every_axis, quest.screened), holds),  # one of a dozen, not of thousands
        (two_at_once, _sure),
    )
    for begin, enough in beginnings:
        stages = begin(quest.scene, data, start, quest.progress)
        if not stages:
            continue
        other = with_stages(Way(start, data), stages, quest.seed)
        if not nearly_at_floor(other.current, other.data):
            other = onwards(other, quest, met=met)
        if enough(other, quest):
            return other
    bold = _boldly(way, quest)
    if bold is not None:
        other = onwards(bold, quest, through=True)
        *earlier, last = other.stages
        other = with_stages(replace(other, stages=tuple(earlier)), (last,), quest.seed)
        if _sure(other, quest):
            return other
    return way


def fewer(way: Way, quest: Quest) -> Way:
    """Two causes with fewer parameters in place of those found one by one; `way` where none explain as well.

    Where what was found first had rivals, what came after may only mend the choice.
    """
    size = _parameters(way)
    if len(way.stages) < 2 or size < 3 or not any(s.rivals for s in way.stages[:-1]):
        return way
    stages = two_at_once(quest.scene, quest.data, quest.start, quest.progress)
    if stages is None:
        return way
    other = with_stages(Way(quest.start, quest.data), stages, quest.seed)
    return other if _parameters(other) < size and reached(other.current, other.data) else way


def _keys(found: Fit) -> Keys:
    return frozenset(a.key for a in found.hypothesis.added)


def _parameters(way: Way) -> int:
    return sum(len(a.parameters) for a in way.current.hypothesis.free)


def _boldly(way: Way, quest: Quest) -> Way | None:
    """From where the search stands, the effect that explains most of the rest of the training recordings.

    Where several causes are missing, one of them alone may raise the error on held-out motion.
    """
    current, deaf = way.current, way.data.unheard()
    if nearly_at_floor(current, way.data):
        return None
    quest.progress("trying what explains most of the training recordings")
    scene, screened = _screened(current, deaf, quest)
    before, later = rejudged(current, deaf), bool(way.stages)
    stage = next_stage(scene, screened, before, deaf, quest.progress, later=later, bold=True)
    return None if stage is None else with_stages(way, (stage,), quest.seed, wide=False)


def _screened(current: Fit, data: Data, quest: Quest) -> tuple[Scene, Sequence[Candidate]]:
    """The loops linearised about where the search stands, and every effect screened there."""
    scene = quest.scene
    if current.hypothesis.added:
        scene = Scene.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
    return scene, candidates(scene, current, data, quest.seed)


def _by_training(scene: Scene, data: Data, start: Fit, progress: Progress) -> tuple[Stage, ...]:
    """A first effect as the training recordings judge it, where they show much more than held-out motion."""
    if not overshadowed(start, data):
        return ()
    progress("beginning with what the training recordings show")
    deaf = data.unheard()
    screened, _ = screen(scene, deaf, start.simulated, ())
    stage = next_stage(scene, screened, rejudged(start, deaf), deaf, progress)
    return () if stage is None else (stage,)


def _sure(way: Way, quest: Quest) -> bool:
    """Whether what was found leaves noise and little else: more than is asked of the usual way."""
    return holds(way, quest) and (
        way.done
        or nearly_at_floor(way.current, way.data)
        or explained(quest.data, quest.start, way.current, way.data) > NEARLY_ALL
    )


def holds(way: Way, quest: Quest) -> bool:
    """Whether what was found explains the data."""
    if way.done or not way.stages:
        return way.done
    shares = [explained(quest.data, quest.start, way.current, way.data)]
    if wanders(way.current):
        shares.append(mostly_explained(quest.data, quest.start, way.current, way.data))
    return max(shares) >= EXPLAINED


def with_stages(way: Way, found: Sequence[Stage], seed: int, *, wide: bool = True) -> Way:
    """The search after further stages, each with the noise of its own model."""
    data, stages = way.data, list(way.stages)
    for stage in found:
        data, runs = _refloor(stage.fit, data, seed, wide=wide)
        stages.append(replace(stage, data=data, runs=runs))
    current = rejudged(stages[-1].fit, data)
    return Way(current, data, tuple(stages), is_consistent(data, current.mean_squares))


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


def _refloor(found: Fit, data: Data, seed: int, *, wide: bool = True) -> tuple[Data, Simulated]:
    """The noise of a model's own runs; `wide`: and how far these part by themselves."""
    simulated = data.replay.with_noise(found.hypothesis.model, seed)
    fresh = floor_of(data.replay, data.training, simulated)
    if wide and wanders(found):
        fresh = replace(fresh, floor=np.maximum(fresh.floor, parting(found, data)))
    return fresh.reweighed(found.mean_squares).heard(found.mean_squares), simulated
