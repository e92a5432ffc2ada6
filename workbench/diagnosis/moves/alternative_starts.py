"""Other starts of the search, for data that forward selection from the nominal model does not explain."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from workbench.core import EffectKey

from ..acceptance import halves_excess, holdout_insensitive, near_noise_floor
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
    """The first alternative start that leads to the noise floor; `node` where none does.

    In this order: a compliance that explains nearly all of the inverse-dynamics residual; an effect chosen on
    training recordings, where the holdout is insensitive; one effect shared by all axes; two effects at once,
    since the best first step of a pair may be neither of them; an inverse-dynamics start; a refinement in
    place of a basic effect; a compliance that explains less; and a provisional step from where forward
    selection ended.
    """
    start, data = problem.start, problem.data
    plain = _accepted_compliance(node, problem)
    if plain is not None:
        return plain
    visited = [effect_keys(step.fit) for step in node.steps]
    starts = (
        (_start_from_training, _explains_nearly_all),
        (partial(shared_effects, problem.screened), explains_data),  # one of a dozen, not of thousands
        (best_pair, _explains_nearly_all),
        (lambda *_: inverse_dynamics_start(problem), _explains_nearly_all),
    )
    for propose, enough in starts:
        if data.budget.spent:
            return node
        steps = propose(problem.linearisation, data, start, problem.progress)
        if not steps:
            continue
        started = with_steps(Node(start, data), steps, problem.seed)
        ended = (
            started
            if near_noise_floor(started.current, started.data)
            else forward_selection(started, problem, visited=visited)
        )
        plain = _without_needless_start(ended, started, problem)
        for other in (ended, started) if plain is ended else (plain,):
            if enough(other, problem):
                return other
    return next(
        (other for other in _provisional_nodes(node, problem) if _explains_nearly_all(other, problem)), node
    )


def with_compliance_from_torque(node: Node, problem: Problem) -> Node:
    """The node of a search that starts from a clear compliance; `node` where that is not much better.

    It is tried where much more than noise is left: inertia alone can explain most of what backlash causes.
    """
    if node.done or near_noise_floor(node.current, node.data):
        return node
    plain = _accepted_compliance(node, problem)
    return plain if plain is not None and halves_excess(plain.current, node.current, node.data) else node


def retry_with_refinement(node: Node, problem: Problem) -> Node:
    """The node of a search that takes a refinement where a basic effect was taken; `node` if not much better.

    It is tried where much more than noise is left: an inertia and a weight explain most of what a wrong
    torque constant and an encoder offset cause. Refinements that were found later anyway are not retried.
    """
    if node.done or near_noise_floor(node.current, node.data):
        return node
    others = (
        o
        for o in _refined(node, problem, set(), effect_keys(node.current))
        if _explains_nearly_all(o, problem)
    )
    return next((o for o in others if halves_excess(o.current, node.current, node.data)), node)


def _accepted_compliance(node: Node, problem: Problem) -> Node | None:
    """The node from the earliest step at which a compliance explains the inverse-dynamics residual, or None.

    Later steps have more true causes (friction that hides backlash), and more that only approximate others.
    """
    for count in range(len(node.steps) + 1):
        plain = _with_compliance(node_after(node.steps[:count], problem), problem, 0.0, POLICY.torque_first)
        continued = _allowing_divergence(plain, problem) if plain else None
        if continued and _explains_nearly_all(continued, problem):
            return continued
    return None


def _without_needless_start(ended: Node, started: Node, problem: Problem) -> Node:
    """The node without effects of its start that effects found later have made needless.

    Rotor inertias on the axes of an arm approximate a load at its end, until the load itself is found.
    """
    if len(started.steps) < 2 or len(ended.steps) == len(started.steps):
        return ended
    last = ended.steps[-1]
    kept = needed(ended.current, ended.data, effect_keys(started.current))
    idle = sorted(effect_keys(ended.current) - effect_keys(kept), key=str)
    if not idle:
        return ended
    problem.progress(f"leaving out {', '.join(map(str, idle))}, needless since {last.added}")
    plain = replace(last, fit=converged(kept, ended.data), dropped=(*last.dropped, *idle))
    return with_last_step(ended, plain, problem.seed)


def _provisional_nodes(node: Node, problem: Problem) -> Iterator[Node]:
    """Nodes after a provisional step; only where they end shows whether they are right."""
    tried: set[tuple[Keys, EffectKey]] = set()
    yield from _refined(node, problem, tried)
    plainly = partial(
        _with_compliance, node_after((), problem), problem, POLICY.torque_first, POLICY.torque_plain
    )
    for leap in (plainly, partial(_provisional_step, node, problem)):
        provisional = None if problem.data.budget.spent else leap()
        if provisional is not None:
            other = _allowing_divergence(provisional, problem)
            yield other
            yield from _refined(other, problem, tried)


def _refined(
    node: Node, problem: Problem, tried: set[tuple[Keys, EffectKey]], known: Keys = frozenset()
) -> Iterator[Node]:
    """The node that repeats the search from the first basic effect that left much more than a refinement did.

    Steps in `tried` are not repeated (new ones are added to it), nor are refinements in `known` tried.
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


def _allowing_divergence(node: Node, problem: Problem, *, basics_first: bool = True) -> Node:
    """The node after forward selection that does not stop at diverging trajectories.

    Nothing is added where hardly more than noise is left. The divergence of the last model widens its floor.
    """
    near = bool(node.steps) and near_noise_floor(node.current, node.data)
    other = (
        node if near else forward_selection(node, problem, allow_divergence=True, basics_first=basics_first)
    )
    if not other.steps:
        return other
    return with_last_step(other, other.steps[-1], problem.seed)


def _provisional_step(node: Node, problem: Problem) -> Node | None:
    """The node with the effect that explains most of the remaining training error; None where there is none.

    Where several causes are missing, one of them alone may raise the error on held-out recordings.
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


def _with_compliance(at: Node, problem: Problem, least: float, most: float) -> Node | None:
    """The node with a compliance that explains the inverse-dynamics residual, not confirmed in the loop.

    `least`, `most`: bounds of the share of the residual torque that it leaves.
    """
    if at.data.budget.spent:
        return None
    linearisation = linearisation_at(at.current, at.data, problem)
    steps = compliance_from_torque(linearisation, at.data, at.current, problem.progress, least, most)
    return with_steps(at, steps, problem.seed, wide=False) if steps else None


def _start_from_training(
    linearisation: Linearisation, data: Data, start: Fit, progress: Progress
) -> tuple[AcceptedStep, ...]:
    """A first step chosen by cross-validation, where the holdout is insensitive; else none."""
    if not holdout_insensitive(start, data):
        return ()
    progress("beginning with what the training recordings show")
    by_folds = data.cross_validated()
    screened, _ = screen(linearisation, by_folds, start.simulated, ())
    step = next_step(linearisation, screened, rescored(start, by_folds), by_folds, progress)
    return () if step is None else (step,)


def _explains_nearly_all(node: Node, problem: Problem) -> bool:
    """Whether a node explains nearly all: alternative starts must explain more than forward selection."""
    return explains_data(node, problem) and (
        node.done
        or near_noise_floor(node.current, node.data)
        or explained(problem.data, problem.start, node.current, node.data) > POLICY.explained_elsewhere
    )
