"""The move that adds effects one at a time, as long as one is accepted (forward selection)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from workbench.effects import contains
from workbench.report.wording import effect_phrase

from ..acceptance import (
    holdout_insensitive,
    improves,
    improves_residual,
    lowers_error,
    near_noise_floor,
    too_little_left,
    unchanged_on_holdout,
)
from ..data import Data
from ..fitting.refinement import converged, prune
from ..hypothesis import Fit
from ..loss import rescored
from ..naming import equivalents_of, named_beside, on_each_drive, special_case
from ..node import Growth, Node, screened_at, with_last_step, with_steps
from ..policy import POLICY
from ..problem import Problem, Progress
from ..removed_share import removed_share
from ..screening.candidate import Candidate
from ..screening.command_path import off_command_path
from ..screening.screen import screen
from ..screening.sensitivity import Linearisation
from ..search_result import AcceptedStep
from ..significance import cancel_each_other, identifiable
from .choice import Explanation, choose, loss_ratios, worse_by
from .trial_fits import SearchState, try_in_order


def grown(node: Node, problem: Problem) -> Node:
    """Return the node after forward selection, by the rules in its `growth`.

    A bold start grows no more from a set of effects from which another has grown before.
    """
    how, begun = node.growth, len(node.steps)
    if how is None or (how.through_divergence and begun and near_noise_floor(node.current, node.data)):
        return _settled(node, problem)
    most = begun + (how.most or problem.limit)
    while len(node.steps) < most and _may_grow(node, how, begun, problem):
        step = _next_step(node, how, problem)
        if step is None:
            break
        problem.progress(f"simulating the noise with {effect_phrase(step.added)}")
        more = node.begun(move=node.move, growth=how, bold=node.bold)
        node = with_steps(more, (step,), problem.seed, wide=not how.through_divergence)
    return _settled(node, problem)


def _may_grow(node: Node, how: Growth, begun: int, problem: Problem) -> bool:
    """Return whether another effect is looked for."""
    if node.done or node.data.budget.spent:
        return False
    if node.steps and too_little_left(node.current, problem.start, node.data):
        return False
    # the residual of diverging trajectories says nothing about a further effect
    if node.diverges and len(node.steps) > begun and not how.through_divergence:
        return False
    new = problem.is_new(node.keys, how.through_divergence)
    return new or not node.bold  # where a bold start comes to is known already


def _next_step(node: Node, how: Growth, problem: Problem) -> AcceptedStep | None:
    """Return the next step of a growing node; None if no effect is accepted."""
    current, data, later = node.current, node.data, bool(node.steps)
    problem.progress(f"screening effects, step {len(node.steps) + 1}")
    linearisation, screened = (
        screened_at(current, data, problem) if later else (problem.linearisation, problem.screened)
    )
    take = partial(next_step, progress=problem.progress, later=later)
    step = take(linearisation, screened, current, data)
    if step is None and holdout_insensitive(current, data):
        # held-out motion may never show what is missing (a torque limit, for one)
        problem.progress("testing on the most informative recordings")
        by_folds = data.cross_validated()
        screened = screen(linearisation, by_folds, current.hypothesis.free)
        step = take(linearisation, screened, rescored(current, by_folds), by_folds)
        if step is not None and not unchanged_on_holdout(step.fit, current, data):
            return None
    if step is None:
        return None
    costless = any(a.key == step.added for a in step.fit.hypothesis.parameter_free)
    if later and not costless and not improves_residual(step.fit, current, problem.start, step.data):
        return None
    return step


def _settled(node: Node, problem: Problem) -> Node:
    """Return the node with its divergence measured, if that was postponed to the end."""
    if node.growth is None or not node.growth.through_divergence or not node.steps:
        return node
    return with_last_step(node, node.steps[-1], problem.seed)


def next_step(
    linearisation: Linearisation,
    candidates: Sequence[Candidate],
    current: Fit,
    data: Data,
    progress: Progress,
    *,
    later: bool = False,
) -> AcceptedStep | None:
    """Return the next accepted step; None if no candidate is accepted.

    What the model file itself states (its drives' inertia behind the transmission, a linkage that was
    identified) has no free parameter and cannot overfit: it comes first. Then basic effects, then
    refinements, unless simpler ones have reached the noise.
    """
    fitted = {a.key for a in current.hypothesis.free}
    new = tuple(c for c in candidates if c.key not in fitted)
    at = SearchState(linearisation, new, current, data, later, progress)
    tried = try_in_order(at)
    helpful = [
        (c, f)
        for c, f in tried
        if improves(f, current, at.excess)
        and lowers_error(f, current, data)
        and identifiable(linearisation, f)
    ]
    step = _step(helpful, tried, at) if helpful else None
    return None if step is None or cancel_each_other(linearisation, step.fit) else step


def _step(helpful: list[Explanation], tried: list[Explanation], at: SearchState) -> AcceptedStep:
    """The step with the best candidate that may be named, without the effects that it makes needless."""
    linearisation, model, data, before = at.linearisation, at.linearisation.model, at.data, at.current
    best = choose(helpful, at.parameter_free, before.test_loss, data)
    candidate, found = special_case(linearisation, *best[:2], helpful, data)
    key = candidate.key
    wider = named_beside(linearisation, at.candidates, candidate, found, before, data)
    each = on_each_drive(linearisation, at.candidates, candidate, before, data)
    wider += [(c, f) for c, f in each if worse_by(f, found) <= 1.0 + POLICY.tie]
    left = [(c.key, f.test_loss) for c, f in tried]
    left += [(c.key, worse_by(f, found) * found.test_loss) for c, f in each]
    kept, needless = prune(found, key, data, before)
    fine = converged(kept, data)
    kept = kept if off_command_path(linearisation, candidate, fine) else fine
    alike = (*best[2], *(c.key for c, _ in wider))
    alike = (*alike, *(k for k in equivalents_of(model, key, data.recordings) if k not in alike))
    shares = {c.key: removed_share(before.test_loss, f.test_loss, at.floor) for c, f in tried}
    removed = at.at_first | shares
    explanations = sorted((*helpful, *wider), key=lambda cf: cf[1].test_loss)
    return AcceptedStep.between(
        before,
        kept,
        key,
        data,
        indistinguishable=(*alike, *(k for k in needless if not contains(key, k))),
        # neither special cases nor refinements of the effect
        others=tuple(
            (c.key, f.hypothesis.model)
            for c, f in explanations
            if c is not candidate
            and (c.key in alike or not contains(c.key, key))
            and not contains(key, c.key)
        ),
        dropped=tuple(a.key for a in before.hypothesis.added if a.key not in kept.hypothesis.keys),
        ranking=tuple(sorted(removed.items(), key=lambda r: -r[1])),
        loss_ratios=loss_ratios(key, found.test_loss, left),
    )
