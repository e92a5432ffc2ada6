"""Forward selection of effects with removal, judged on data that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.comparison import MeasuredMotion, cannot_run, noise_rules
from workbench.core import Disagreement, Identifiability, Recording, SimulationError
from workbench.effects import effect_named
from workbench.models import Model

from .checks.sign_check import refuse_mirrored
from .data import gather
from .loss import explained, floor_of_judging, mostly_explained
from .moves.alternative_starts import fewer, otherwise, what_the_torque_shows, what_was_passed_over
from .moves.grid_refinement import honed
from .moves.joint_solution import Joint, jointly
from .moves.merge import one_for_two
from .moves.replace import others_instead
from .moves.simplify import simpler, without
from .moves.trial_fits import Progress
from .node import Way, after, holds, is_consistent, onwards, wanders, with_last, with_stages
from .policy import POLICY
from .problem import Quest, quest_of
from .removed_share import removed_share
from .screening.identifiability import disagreements, identifiability_of
from .screening.screen import silent
from .search_result import Search
from .significance import stands_out


class UnstableLoop(SimulationError):
    """The model as given cannot run in the loops of its recordings."""


def search(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    seed: int = 0,
    limit: int | None = None,
    progress: Progress = lambda text: None,
    *,
    only_jointly: bool = False,
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
        limit: most effects to add one by one; None: as many as the policy has.
        progress: told what is being done.
        only_jointly: ask nothing but the joint solution.

    Raises:
        UnstableLoop: the model cannot run the recordings.
    """
    progress("simulating the model and its noise")
    try:
        data, simulated = gather(model, training, held_out, seed)
    except SimulationError as error:
        raise UnstableLoop(str(error)) from error
    if noise_rules(data.score(data.floor), data.recordings):
        raise UnstableLoop(cannot_run(model.name, data.score(data.floor)))
    most = POLICY.most_effects if limit is None else limit
    quest = quest_of(model, data, simulated.clean, most, seed, progress)
    start, first = quest.start, quest.data
    before = is_consistent(first, start.mean_squares)
    way, joint = Way(start, first, done=before), None
    if not before:
        if not data.replay.on_ground:
            refuse_mirrored(model, training, first.score(start.mean_squares), first.score(first.floor))
        way, joint = _only_jointly(way, quest) if only_jointly else _explained(quest)
    current, data = way.current, way.data
    # a signal that is a little off after all that could be found is no sign of one more effect
    done = way.done or (len(way.stages) > 0 and is_consistent(data, current.mean_squares, by_signal=False))
    return Search(
        model,
        start,
        first,
        simulated,
        way.stages,
        () if before or only_jointly or (joint and quest.is_dear) else quest.screened,
        before,
        done,
        explained(first, start, current, data),
        mostly_explained(first, start, current, data) if wanders(current) else 0.0,
        joint.adequacy if joint else {},
        joint.near if joint else (),
        *((None, ()) if only_jointly else _told(quest)),
        joint is not None,
    )


def _told(quest: Quest) -> tuple[Identifiability | None, tuple[Disagreement, ...]]:
    """What the recordings can tell apart, and which of them disagree; nothing where that cannot be asked."""
    if quest.linear is None:
        return None, ()
    linear, data, names = quest.linear, quest.data, [r.name for r in quest.data.recordings]
    model = quest.start.hypothesis.model
    return identifiability_of(linear, model, data, silent(quest.scene, data)), disagreements(linear, names)


def _only_jointly(start: Way, quest: Quest) -> tuple[Way, Joint | None]:
    joint = jointly(quest)
    return (start, None) if joint is None else (joint.way, joint)


def _explained(quest: Quest) -> tuple[Way, Joint | None]:
    """What is missing, and the joint solution where that is the answer.

    All axes and effects are solved together along the measured motion where no single effect explains the
    recordings. That is the answer where more is missing than can be added one by one; where plain causes lead
    to the noise; where several are certain that explain most; and where the search one by one does not end in
    an explanation, or in one that takes more parameters.
    """
    start, several = Way(quest.start, quest.data), quest.limit > 1
    joint = jointly(quest) if several and (_is_long(quest) or not _one_may_do(quest)) else None
    if joint and (joint.size > quest.limit or (_is_plain(joint) and not _one_may_do(quest))):
        return joint.way, joint
    if joint and _are_several(joint):
        # what is no torque along the motion may be missing beside them
        way = onwards(joint.way, quest)
        if holds(way, quest):
            return _plain(_simplified(way, quest.seed, quest.progress), quest), None
        if explained(quest.data, quest.start, joint.way.current, joint.way.data) > POLICY.certain_share:
            return joint.way, joint
    way = _one_by_one(start, quest)
    if not several or (holds(way, quest) and len(way.stages) < 2):
        return way, None
    joint = joint or jointly(quest)
    if joint is None or (holds(way, quest) and not _is_simpler(joint.way, way)):
        return way, None
    return joint.way, joint


def _are_several(joint: Joint) -> bool:
    """Whether so much is certain, on more than one axis, that it does not stand for one other cause."""
    keys = [stage.added for stage in joint.way.stages]
    return not joint.way.done and len(keys) >= POLICY.certain_effects and len({k.axis for k in keys}) > 1


def _is_plain(joint: Joint) -> bool:
    """Whether numbers of drives and links alone lead to the noise, which nothing else stands behind."""
    keys = [stage.added for stage in joint.way.stages]
    return joint.way.done and len(keys) > 1 and all(k.axis and _is_number(k.effect) for k in keys)


def _is_number(effect: str) -> bool:
    """Whether an effect corrects a number that every drive or link has."""
    return effect_named(effect).basic or effect_named(effect).adds_up


def _is_simpler(one: Way, other: Way) -> bool:
    """Whether a way that leads to the noise takes fewer parameters than another."""
    return one.done and one.current.hypothesis.size < other.current.hypothesis.size


def _is_long(quest: Quest) -> bool:
    """Whether single effects are too dear or too few to begin with: no loop, or more axes than effects."""
    return isinstance(quest.data.replay, MeasuredMotion) or quest.is_dear


def _one_may_do(quest: Quest) -> bool:
    """Whether a single effect, as screened, explains the recordings."""
    least = min((c.judged for c in quest.screened), default=quest.start.judged)
    return removed_share(quest.start.judged, least, floor_of_judging(quest.data)) >= POLICY.explained


def _one_by_one(way: Way, quest: Quest) -> Way:
    """One effect after the other, or from other beginnings where that leads nowhere."""
    way = _honed(onwards(way, quest), quest)
    if not holds(way, quest) and quest.limit > 1:
        other = otherwise(way, quest)
        way = way if other is way else _honed(other, quest)
    elif quest.limit > 1:
        way = fewer(way, quest)
        way = what_was_passed_over(what_the_torque_shows(way, quest), quest)
        way = _honed(way, quest)
    way = one_for_two(others_instead(way, quest), quest)
    return _plain(_simplified(way, quest.seed, quest.progress), quest)


def _honed(way: Way, quest: Quest) -> Way:
    """With gaps of the size with which loops run best."""
    if not wanders(way.current) or way.data.effort.spent:
        return way
    quest.progress("trying sizes of the gap")
    better = honed(way.current, way.data)
    if better is way.current:
        return way
    return with_last(way, replace(way.stages[-1], fit=better), quest.seed)


def _plain(way: Way, quest: Quest) -> Way:
    """Without last effects that may be none; what they explained stays unexplained."""
    stages = way.stages
    while stages:
        last = next(a for a in stages[-1].fit.hypothesis.added if a.key == stages[-1].added)
        if last in stages[-1].fit.hypothesis.stated or stands_out(last):
            break
        stages = stages[:-1]
    if len(stages) == len(way.stages):
        return way
    return after(stages, quest)


def _simplified(way: Way, seed: int, progress: Progress) -> Way:
    """Once all causes are there, without earlier ones that may be none, and simpler forms of the others."""
    for stage in way.stages[:-1]:
        last = way.stages[-1]
        rest = without(stage, way.current, way.data) if stage.added != last.added else None
        if rest:
            way = with_last(way, replace(last, fit=rest, dropped=(*last.dropped, stage.added)), seed)
    for stage in way.stages:
        simple = simpler(stage, way.current, way.data, progress, last=stage is way.stages[-1])
        if simple and stage is way.stages[-1]:
            simple = (replace(simple[0], dropped=stage.dropped), *simple[1:])
            way = replace(way, stages=way.stages[:-1])
        if simple:
            way = with_stages(way, simple, seed)
    return way
