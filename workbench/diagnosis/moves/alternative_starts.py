"""How else to begin a search, where one effect after the other leads nowhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from workbench.core import EffectKey

from ..acceptance import mends, nearly_at_floor, overshadowed, reached
from ..data import Data
from ..fitting.refinement import polished
from ..hypothesis import Fit
from ..loss import explained, rejudged
from ..node import Keys, Way, after, holds, keys_of, onwards, scene_at, screened_at, with_last, with_stages
from ..policy import POLICY
from ..problem import Quest
from ..screening.compliance import other_causes
from ..screening.screen import screen
from ..screening.sensitivity import Scene
from ..search_result import Stage
from .add import next_stage
from .choice import passed_over
from .compliance_from_torque import plain_by_torque
from .inverse_dynamics import along_the_motion
from .pairs import two_at_once
from .shared_effects import needed, on_every_axis
from .trial_fits import Progress


def otherwise(way: Way, quest: Quest) -> Way:
    """The first of the other ways that leads to the noise; `way` where none does.

    With what the torque shows to give way, where that leaves next to nothing of it; by what the training
    recordings show, where held-out motion shows little; with the same cause on every axis, each of which has
    its share; with two effects at once, since the best first step of a pair may be neither of them; with a
    refinement that a basic effect went before; with what the torque shows less plainly to give way; and
    boldly on from where the first way ended.
    """
    start, data = quest.start, quest.data
    plain = _plainly_by_torque(way, quest)
    if plain is not None:
        return plain
    met = [keys_of(stage.fit) for stage in way.stages]
    beginnings = (
        (_by_training, _sure),
        (partial(on_every_axis, quest.screened), holds),  # one of a dozen, not of thousands
        (two_at_once, _sure),
        (lambda *_: along_the_motion(quest), _sure),
    )
    for begin, enough in beginnings:
        if data.effort.spent:
            return way
        stages = begin(quest.scene, data, start, quest.progress)
        if not stages:
            continue
        begun = with_stages(Way(start, data), stages, quest.seed)
        ended = begun if nearly_at_floor(begun.current, begun.data) else onwards(begun, quest, met=met)
        plain = _without_stand_ins(ended, begun, quest)
        for other in (ended, begun) if plain is ended else (plain,):
            if enough(other, quest):
                return other
    return next((other for other in _leaps(way, quest) if _sure(other, quest)), way)


def what_the_torque_shows(way: Way, quest: Quest) -> Way:
    """With what plainly gives way, where much more than noise is left; `way` where that is no better.

    Most of what a gap leaves may be explained by inertia in its place.
    """
    if way.done or nearly_at_floor(way.current, way.data):
        return way
    plain = _plainly_by_torque(way, quest)
    return plain if plain is not None and mends(plain.current, way.current, way.data) else way


def what_was_passed_over(way: Way, quest: Quest) -> Way:
    """With a refinement that a basic effect went before, where much more than noise is left; else `way`.

    An inertia and a weight explain most of what a torque constant and an encoder's offset do. What came later
    all the same needs no other beginning.
    """
    if way.done or nearly_at_floor(way.current, way.data):
        return way
    others = (o for o in _refined(way, quest, set(), keys_of(way.current)) if _sure(o, quest))
    return next((o for o in others if mends(o.current, way.current, way.data)), way)


def _plainly_by_torque(way: Way, quest: Quest) -> Way | None:
    """From the first place on a way where the torque shows something to give way that leaves nothing of it.

    Later ones have more that is true, as friction that hides a gap, and more that only stands for the rest.
    """
    for count in range(len(way.stages) + 1):
        plain = _by_torque(after(way.stages[:count], quest), quest, 0.0, POLICY.torque_first)
        led = _through(plain, quest) if plain else None
        if led and _sure(led, quest):
            return led
    return None


def _without_stand_ins(ended: Way, begun: Way, quest: Quest) -> Way:
    """Without effects of several that it began with at once, which those found later have made needless.

    Rotors on the axes of an arm stand in for a load at its end, until the load itself is found.
    """
    if len(begun.stages) < 2 or len(ended.stages) == len(begun.stages):
        return ended
    last = ended.stages[-1]
    kept = needed(ended.current, ended.data, keys_of(begun.current))
    idle = sorted(keys_of(ended.current) - keys_of(kept), key=str)
    if not idle:
        return ended
    quest.progress(f"leaving out {', '.join(map(str, idle))}, needless since {last.added}")
    plain = replace(last, fit=polished(kept, ended.data), dropped=(*last.dropped, *idle))
    return with_last(ended, plain, quest.seed)


def _leaps(way: Way, quest: Quest) -> Iterator[Way]:
    """Ways of which nothing but their end can tell whether they are right."""
    tried: set[tuple[Keys, EffectKey]] = set()
    yield from _refined(way, quest, tried)
    plainly = partial(_by_torque, after((), quest), quest, POLICY.torque_first, POLICY.torque_plain)
    for leap in (plainly, partial(_boldly, way, quest)):
        bold = None if quest.data.effort.spent else leap()
        if bold is not None:
            other = _through(bold, quest)
            yield other
            yield from _refined(other, quest, tried)


def _refined(
    way: Way, quest: Quest, tried: set[tuple[Keys, EffectKey]], known: Keys = frozenset()
) -> Iterator[Way]:
    """From the first step that took a basic effect, though a refinement left much less, with that one.

    No step is taken again that is among `tried`, to which it is added, nor for a refinement of those `known`.
    """
    if quest.data.effort.spent:
        return
    for k, stage in enumerate(way.stages):
        before = way.stages[:k]
        current = before[-1].fit if before else quest.start
        step = keys_of(current), stage.added
        better = passed_over(stage.added, stage.ranking)
        if better is not None and better not in known and step not in tried:
            tried.add(step)
            quest.progress(f"beginning again from where {stage.added} was taken")
            yield _through(after(before, quest), quest, basics_first=False)
            return


def fewer(way: Way, quest: Quest) -> Way:
    """Two causes with fewer parameters in place of those found one by one; `way` where none explain as well.

    Where what was found first had rivals, what came after may only mend the choice.
    """
    size = way.current.hypothesis.size
    few = len(way.stages) < 2 or size < 3
    if few or quest.data.effort.spent or not any(_doubtful(s, way, quest) for s in way.stages[:-1]):
        return way
    stages = two_at_once(quest.scene, quest.data, quest.start, quest.progress)
    if stages is None:
        return way
    other = with_stages(Way(quest.start, quest.data), stages, quest.seed)
    return other if other.current.hypothesis.size < size and reached(other.current, other.data) else way


def _doubtful(stage: Stage, way: Way, quest: Quest) -> bool:
    """Whether another cause did as well, not only the same machine in other words."""
    model = quest.start.hypothesis.model
    return bool(other_causes(model, stage.added, stage.rivals_of(way.current)))


def _through(way: Way, quest: Quest, *, basics_first: bool = True) -> Way:
    """Onwards also where runs part by themselves, unless hardly more than noise is left.

    By how much they part is asked of the last model.
    """
    near = bool(way.stages) and nearly_at_floor(way.current, way.data)
    other = way if near else onwards(way, quest, through=True, basics_first=basics_first)
    if not other.stages:
        return other
    return with_last(other, other.stages[-1], quest.seed)


def _boldly(way: Way, quest: Quest) -> Way | None:
    """From where the search stands, the effect that explains most of the rest of the training recordings.

    Where several causes are missing, one of them alone may raise the error on held-out motion.
    """
    current, deaf = way.current, way.data.unheard()
    if nearly_at_floor(current, way.data):
        return None
    quest.progress("trying what explains most of the training recordings")
    scene, screened = screened_at(current, deaf, quest)
    before, later = rejudged(current, deaf), bool(way.stages)
    stage = next_stage(scene, screened, before, deaf, quest.progress, later=later, bold=True)
    return None if stage is None else with_stages(way, (stage,), quest.seed, wide=False)


def _by_torque(at: Way, quest: Quest, least: float, most: float) -> Way | None:
    """On from where a search stands with what the torque shows to give way, and no closed loop yet.

    `least`, `most`: what it leaves of the torque that is lacking there.
    """
    if at.data.effort.spent:
        return None
    scene = scene_at(at.current, at.data, quest)
    stages = plain_by_torque(scene, at.data, at.current, quest.progress, least, most)
    return with_stages(at, stages, quest.seed, wide=False) if stages else None


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
        or explained(quest.data, quest.start, way.current, way.data) > POLICY.explained_elsewhere
    )
