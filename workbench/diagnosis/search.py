"""The search: forward selection, alternative starts, and moves that replace, merge and simplify."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.comparison import MeasuredMotion, cannot_run, noise_rules
from workbench.core import Disagreement, Identifiability, Recording, SimulationError
from workbench.effects import effect_named, kinds
from workbench.models import Model

from .checks.sign_check import refuse_wrong_sign_in_loop
from .data import gather
from .loss import explained, median_explained, test_noise_floor
from .moves.alternative_starts import alternative_starts, retry_with_refinement, with_compliance_from_torque
from .moves.fewer_parameters import with_fewer_parameters
from .moves.grid_refinement import refined_on_grid
from .moves.joint_solution import JointSolution, solve_jointly
from .moves.merge import merge_effects
from .moves.replace import replace_effects
from .moves.simplify import simplify, without
from .moves.trial_fits import Progress
from .node import (
    Node,
    diverges,
    explains_data,
    forward_selection,
    is_consistent,
    node_after,
    with_last_step,
    with_steps,
)
from .policy import POLICY
from .problem import Problem, problem_of
from .removed_share import removed_share
from .screening.identifiability import disagreements, identifiability_of
from .search_result import SearchResult
from .significance import is_significant


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
) -> SearchResult:
    """The result of a search for missing effects: it ends at the noise floor or where nothing helps.

    Effects are added one at a time. Where that leaves the data unexplained, alternative starts are tried,
    which must explain more in the end.

    Args:
        model: where to start.
        training: recordings for fitting.
        held_out: recordings for testing; without informative ones, folds of the training data are left out.
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
    problem = problem_of(model, data, simulated.clean, most, seed, progress)
    start, first = problem.start, problem.data
    known, disagreeing = (None, ()) if only_jointly else _distinguishable(problem)
    before = is_consistent(first, start.mean_squares)
    node, joint = Node(start, first, done=before), None
    if not before:
        if not data.replay.on_ground:
            refuse_wrong_sign_in_loop(
                model, training, first.score(start.mean_squares), first.score(first.floor)
            )
        node, joint = _only_jointly(node, problem) if only_jointly else _explained(problem)
    current, data = node.current, node.data
    # a signal that is a little off after all that could be found is no sign of one more effect
    done = node.done or (len(node.steps) > 0 and is_consistent(data, current.mean_squares, by_signal=False))
    return SearchResult(
        model,
        start,
        first,
        simulated,
        node.steps,
        () if before or only_jointly or (joint and problem.is_expensive) else problem.screened,
        before,
        done,
        explained(first, start, current, data),
        median_explained(first, start, current, data) if diverges(current) else 0.0,
        joint.adequacy if joint else {},
        joint.near if joint else (),
        known,
        disagreeing,
        joint is not None,
        None if only_jointly else problem.linear,
    )


def _distinguishable(problem: Problem) -> tuple[Identifiability | None, tuple[Disagreement, ...]]:
    """Identifiability and disagreement of the recordings; nothing where there is no linear problem."""
    if problem.linear is None:
        return None, ()
    known = identifiability_of(problem.linear, problem.linearisation, problem.data)
    problem.progress(f"the recordings tell {len(known.separable)} of {known.count} effects from all others")
    return known, disagreements(problem.linear, [r.name for r in problem.data.recordings])


def _only_jointly(start: Node, problem: Problem) -> tuple[Node, JointSolution | None]:
    joint = solve_jointly(problem)
    return (start, None) if joint is None else (joint.node, joint)


def _explained(problem: Problem) -> tuple[Node, JointSolution | None]:
    """The last node, and the joint solution where that is the answer.

    All axes and effects are solved together along the measured motion where no single effect explains the
    recordings. That is the answer where more is missing than can be added one by one; where plain causes lead
    to the noise; where several are certain that explain most; and where the search one by one does not end in
    an explanation, or in one that takes more parameters.
    """
    start, several = Node(problem.start, problem.data), problem.limit > 1
    joint = (
        solve_jointly(problem)
        if several and (_needs_joint_start(problem) or not _one_effect_may_suffice(problem))
        else None
    )
    if joint and (
        joint.size > problem.limit or (_corrections_suffice(joint) and not _one_effect_may_suffice(problem))
    ):
        return joint.node, joint
    if joint and _has_several_certain(joint):
        # what is no torque along the motion may be missing beside them
        node = forward_selection(joint.node, problem)
        if explains_data(node, problem):
            return _without_insignificant_end(
                _simplified(node, problem.seed, problem.progress), problem
            ), None
        if explained(problem.data, problem.start, joint.node.current, joint.node.data) > POLICY.certain_share:
            return joint.node, joint
    node = _one_by_one(start, problem)
    if not several or (explains_data(node, problem) and len(node.steps) < 2):
        return node, None
    joint = joint or solve_jointly(problem)
    if joint is None or (explains_data(node, problem) and not _is_simpler(joint.node, node)):
        return node, None
    return joint.node, joint


def _has_several_certain(joint: JointSolution) -> bool:
    """Whether several effects on more than one axis are certain, too many to approximate one other cause."""
    keys = [step.added for step in joint.node.steps]
    return not joint.node.done and len(keys) >= POLICY.certain_effects and len({k.axis for k in keys}) > 1


def _corrections_suffice(joint: JointSolution) -> bool:
    """Whether corrections of drive and link parameters alone reach the noise floor."""
    keys = [step.added for step in joint.node.steps]
    return joint.node.done and len(keys) > 1 and all(k.axis and _corrects_a_number(k.effect) for k in keys)


def _corrects_a_number(effect: str) -> bool:
    """Whether an effect corrects a number that every drive or link has."""
    return effect_named(effect).search.basic or kinds.adds_up(effect_named(effect))


def _is_simpler(one: Node, other: Node) -> bool:
    """Whether a node at the noise floor has fewer parameters than another."""
    return one.done and one.current.hypothesis.size < other.current.hypothesis.size


def _needs_joint_start(problem: Problem) -> bool:
    """Whether to start with the joint solution: no loop, or more axes than effects may be added."""
    return isinstance(problem.data.replay, MeasuredMotion) or problem.is_expensive


def _one_effect_may_suffice(problem: Problem) -> bool:
    """Whether a single effect, as screened, explains the recordings."""
    least = min((c.test_loss for c in problem.screened), default=problem.start.test_loss)
    return removed_share(problem.start.test_loss, least, test_noise_floor(problem.data)) >= POLICY.explained


def _one_by_one(node: Node, problem: Problem) -> Node:
    """The node after forward selection, or an alternative start, and the moves that improve it."""
    node = _refined_on_grid(forward_selection(node, problem), problem)
    if not explains_data(node, problem) and problem.limit > 1:
        other = alternative_starts(node, problem)
        node = node if other is node else _refined_on_grid(other, problem)
    elif problem.limit > 1:
        node = with_fewer_parameters(node, problem)
        node = retry_with_refinement(with_compliance_from_torque(node, problem), problem)
        node = _refined_on_grid(node, problem)
    node = merge_effects(replace_effects(node, problem), problem)
    return _without_insignificant_end(_simplified(node, problem.seed, problem.progress), problem)


def _refined_on_grid(node: Node, problem: Problem) -> Node:
    """The node with backlash refined on a grid."""
    if not diverges(node.current) or node.data.budget.spent:
        return node
    problem.progress("trying sizes of the gap")
    better = refined_on_grid(node.current, node.data)
    if better is node.current:
        return node
    return with_last_step(node, replace(node.steps[-1], fit=better), problem.seed)


def _without_insignificant_end(node: Node, problem: Problem) -> Node:
    """The node without insignificant last effects; what they explained stays unexplained."""
    steps = node.steps
    while steps:
        last = next(a for a in steps[-1].fit.hypothesis.added if a.key == steps[-1].added)
        if last in steps[-1].fit.hypothesis.parameter_free or is_significant(last):
            break
        steps = steps[:-1]
    if len(steps) == len(node.steps):
        return node
    return node_after(steps, problem)


def _simplified(node: Node, seed: int, progress: Progress) -> Node:
    """The node without insignificant earlier effects, and with special cases where they fit as well."""
    for step in node.steps[:-1]:
        last = node.steps[-1]
        rest = without(step, node.current, node.data) if step.added != last.added else None
        if rest:
            node = with_last_step(node, replace(last, fit=rest, dropped=(*last.dropped, step.added)), seed)
    for step in node.steps:
        simple = simplify(step, node.current, node.data, progress, last=step is node.steps[-1])
        if simple and step is node.steps[-1]:
            simple = (replace(simple[0], dropped=step.dropped), *simple[1:])
            node = replace(node, steps=node.steps[:-1])
        if simple:
            node = with_steps(node, simple, seed)
    return node
