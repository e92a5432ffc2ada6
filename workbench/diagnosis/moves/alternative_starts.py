"""How else to begin a search, where one effect after the other leads nowhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from workbench.core import EffectKey

from ..acceptance import at_noise_floor, halves_excess, holdout_insensitive, near_noise_floor
from ..data import Data
from ..fitting.refinement import converged
from ..hypothesis import Fit
from ..loss import explained, rescored
from ..node import (
    Keys,
    Node,
    effect_keys,
    explains_data,
    forward_selection,
    linearisation_at,
    node_after,
    screened_at,
    with_last_step,
    with_steps,
)
from ..policy import POLICY
from ..problem import Problem
from ..screening.compliance import other_causes
from ..screening.screen import screen
from ..screening.sensitivity import Linearisation
from ..search_result import AcceptedStep
from .add import next_step
from .choice import better_refinement
from .compliance_from_torque import compliance_from_torque
from .inverse_dynamics import inverse_dynamics_start
from .pairs import best_pair
from .shared_effects import needed, shared_effects
from .trial_fits import Progress


def alternative_starts(node: Node, problem: Problem) -> Node:
    """The first of the other ways that leads to the noise; `node` where none does.

    With what the torque shows to give way, where that leaves next to nothing of it; by what the training
    recordings show, where held-out motion shows little; with the same cause on every axis, each of which has
    its share; with two effects at once, since the best first step of a pair may be neither of them; with a
    refinement that a basic effect went before; with what the torque shows less plainly to give way; and
    boldly on from where the first way ended.
    """
    start, data = problem.start, problem.data
    plain = _accepted_compliance(node, problem)
    if plain is not None:
        return plain
    visited = [effect_keys(step.fit) for step in node.steps]
    beginnings = (
        (_by_training, _sure),
        (partial(shared_effects, problem.screened), explains_data),  # one of a dozen, not of thousands
        (best_pair, _sure),
        (lambda *_: inverse_dynamics_start(problem), _sure),
    )
    for begin, enough in beginnings:
        if data.budget.spent:
            return node
        steps = begin(problem.linearisation, data, start, problem.progress)
        if not steps:
            continue
        begun = with_steps(Node(start, data), steps, problem.seed)
        ended = (
            begun
            if near_noise_floor(begun.current, begun.data)
            else forward_selection(begun, problem, visited=visited)
        )
        plain = _without_stand_ins(ended, begun, problem)
        for other in (ended, begun) if plain is ended else (plain,):
            if enough(other, problem):
                return other
    return next((other for other in _leaps(node, problem) if _sure(other, problem)), node)


def with_compliance_from_torque(node: Node, problem: Problem) -> Node:
    """With what plainly gives way, where much more than noise is left; `node` where that is no better.

    Most of what a gap leaves may be explained by inertia in its place.
    """
    if node.done or near_noise_floor(node.current, node.data):
        return node
    plain = _accepted_compliance(node, problem)
    return plain if plain is not None and halves_excess(plain.current, node.current, node.data) else node


def retry_with_refinement(node: Node, problem: Problem) -> Node:
    """With a refinement that a basic effect went before, where much more than noise is left; else `node`.

    An inertia and a weight explain most of what a torque constant and an encoder's offset do. What came later
    all the same needs no other beginning.
    """
    if node.done or near_noise_floor(node.current, node.data):
        return node
    others = (o for o in _refined(node, problem, set(), effect_keys(node.current)) if _sure(o, problem))
    return next((o for o in others if halves_excess(o.current, node.current, node.data)), node)


def _accepted_compliance(node: Node, problem: Problem) -> Node | None:
    """From the first place on a way where the torque shows something to give way that leaves nothing of it.

    Later ones have more that is true, as friction that hides a gap, and more that only stands for the rest.
    """
    for count in range(len(node.steps) + 1):
        plain = _by_torque(node_after(node.steps[:count], problem), problem, 0.0, POLICY.torque_first)
        led = _allowing_divergence(plain, problem) if plain else None
        if led and _sure(led, problem):
            return led
    return None


def _without_stand_ins(ended: Node, begun: Node, problem: Problem) -> Node:
    """Without effects of several that it began with at once, which those found later have made needless.

    Rotors on the axes of an arm stand in for a load at its end, until the load itself is found.
    """
    if len(begun.steps) < 2 or len(ended.steps) == len(begun.steps):
        return ended
    last = ended.steps[-1]
    kept = needed(ended.current, ended.data, effect_keys(begun.current))
    idle = sorted(effect_keys(ended.current) - effect_keys(kept), key=str)
    if not idle:
        return ended
    problem.progress(f"leaving out {', '.join(map(str, idle))}, needless since {last.added}")
    plain = replace(last, fit=converged(kept, ended.data), dropped=(*last.dropped, *idle))
    return with_last_step(ended, plain, problem.seed)


def _leaps(node: Node, problem: Problem) -> Iterator[Node]:
    """Ways of which nothing but their end can tell whether they are right."""
    tried: set[tuple[Keys, EffectKey]] = set()
    yield from _refined(node, problem, tried)
    plainly = partial(_by_torque, node_after((), problem), problem, POLICY.torque_first, POLICY.torque_plain)
    for leap in (plainly, partial(_provisional_step, node, problem)):
        provisional = None if problem.data.budget.spent else leap()
        if provisional is not None:
            other = _allowing_divergence(provisional, problem)
            yield other
            yield from _refined(other, problem, tried)


def _refined(
    node: Node, problem: Problem, tried: set[tuple[Keys, EffectKey]], known: Keys = frozenset()
) -> Iterator[Node]:
    """From the first step that took a basic effect, though a refinement left much less, with that one.

    No step is taken again that is among `tried`, to which it is added, nor for a refinement of those `known`.
    """
    if problem.data.budget.spent:
        return
    for k, step in enumerate(node.steps):
        before = node.steps[:k]
        current = before[-1].fit if before else problem.start
        taken = effect_keys(current), step.added
        better = better_refinement(step.added, step.ranking)
        if better is not None and better not in known and taken not in tried:
            tried.add(taken)
            problem.progress(f"beginning again from where {step.added} was taken")
            yield _allowing_divergence(node_after(before, problem), problem, basics_first=False)
            return


def with_fewer_parameters(node: Node, problem: Problem) -> Node:
    """Two causes with fewer parameters in place of those found one by one; `node` where none explain as well.

    Where what was found first had rivals, what came after may only mend the choice.
    """
    size = node.current.hypothesis.size
    few = len(node.steps) < 2 or size < 3
    if few or problem.data.budget.spent or not any(_doubtful(s, node, problem) for s in node.steps[:-1]):
        return node
    steps = best_pair(problem.linearisation, problem.data, problem.start, problem.progress)
    if steps is None:
        return node
    other = with_steps(Node(problem.start, problem.data), steps, problem.seed)
    return (
        other if other.current.hypothesis.size < size and at_noise_floor(other.current, other.data) else node
    )


def _doubtful(step: AcceptedStep, node: Node, problem: Problem) -> bool:
    """Whether another cause did as well, not only the same machine in other words."""
    model = problem.start.hypothesis.model
    return bool(other_causes(model, step.added, step.indistinguishable_at(node.current)))


def _allowing_divergence(node: Node, problem: Problem, *, basics_first: bool = True) -> Node:
    """Onwards also where runs part by themselves, unless hardly more than noise is left.

    By how much they part is asked of the last model.
    """
    near = bool(node.steps) and near_noise_floor(node.current, node.data)
    other = (
        node if near else forward_selection(node, problem, allow_divergence=True, basics_first=basics_first)
    )
    if not other.steps:
        return other
    return with_last_step(other, other.steps[-1], problem.seed)


def _provisional_step(node: Node, problem: Problem) -> Node | None:
    """From where the search stands, the effect that explains most of the rest of the training recordings.

    Where several causes are missing, one of them alone may raise the error on held-out motion.
    """
    current, by_folds = node.current, node.data.cross_validated()
    if near_noise_floor(current, node.data):
        return None
    problem.progress("trying what explains most of the training recordings")
    linearisation, screened = screened_at(current, by_folds, problem)
    before, later = rescored(current, by_folds), bool(node.steps)
    step = next_step(
        linearisation, screened, before, by_folds, problem.progress, later=later, provisional=True
    )
    return None if step is None else with_steps(node, (step,), problem.seed, wide=False)


def _by_torque(at: Node, problem: Problem, least: float, most: float) -> Node | None:
    """On from where a search stands with what the torque shows to give way, and no closed loop yet.

    `least`, `most`: what it leaves of the torque that is lacking there.
    """
    if at.data.budget.spent:
        return None
    linearisation = linearisation_at(at.current, at.data, problem)
    steps = compliance_from_torque(linearisation, at.data, at.current, problem.progress, least, most)
    return with_steps(at, steps, problem.seed, wide=False) if steps else None


def _by_training(
    linearisation: Linearisation, data: Data, start: Fit, progress: Progress
) -> tuple[AcceptedStep, ...]:
    """A first effect as the training recordings judge it, where they show much more than held-out motion."""
    if not holdout_insensitive(start, data):
        return ()
    progress("beginning with what the training recordings show")
    by_folds = data.cross_validated()
    screened, _ = screen(linearisation, by_folds, start.simulated, ())
    step = next_step(linearisation, screened, rescored(start, by_folds), by_folds, progress)
    return () if step is None else (step,)


def _sure(node: Node, problem: Problem) -> bool:
    """Whether what was found leaves noise and little else: more than is asked of the usual way."""
    return explains_data(node, problem) and (
        node.done
        or near_noise_floor(node.current, node.data)
        or explained(problem.data, problem.start, node.current, node.data) > POLICY.explained_elsewhere
    )
