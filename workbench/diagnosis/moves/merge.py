"""The move that merges two effects with many parameters, or two delays, into one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, islice

from workbench.core import EffectKey
from workbench.models import AppliedEffect

from ..fitting.delays import is_delay, one_delay_for_two
from ..fitting.fit import fit
from ..fitting.refinement import converged, with_candidate
from ..hypothesis import Fit, Hypothesis
from ..loss import rescored
from ..node import Node, with_steps
from ..policy import POLICY
from ..problem import Problem
from ..screening.compliance import equivalents_at_joint
from ..screening.sensitivity import Linearisation
from ..screening.stiction import candidates
from ..search_result import AcceptedStep, steps_through
from ..significance import identifiable


def merged(node: Node, problem: Problem) -> Iterator[Node]:
    """Nodes with one effect of at most half the parameters in place of two.

    A payload at the foot changes inertia and weight of the linkage together, and is taken for both while a
    third cause is missing. Two delays are merged into one of their total length.
    """
    for pair in combinations(node.current.hypothesis.free, 2):
        if all(is_delay(a.key) for a in pair):
            found = _as_late_as_both(pair, node, problem)
        elif sum(len(a.parameters) for a in pair) >= POLICY.merge_from:
            found = _in_place_of(pair, node, problem)
        else:
            continue
        if found is not None:
            root = Node(problem.start, problem.data, as_good=True)
            yield with_steps(root, _steps(found, pair, node, problem.start), problem.seed)


def _in_place_of(
    pair: tuple[AppliedEffect, AppliedEffect], node: Node, problem: Problem
) -> tuple[EffectKey, Fit] | None:
    """The effect that replaces both, with its fit beside all others; None where none fits as well."""
    current, data = node.current, node.data
    one, other = pair
    problem.progress(f"asking whether one cause will do for {one.key} and {other.key}")
    (rest,) = fit([current.hypothesis.without(one.key).without(other.key)], data, iterations=1)
    if rest is None:
        return None
    linearisation = Linearisation.of(rest.hypothesis.model, data, rest.simulated, len(data.recordings))
    few = POLICY.merge_size * (current.hypothesis.size - rest.hypothesis.size)
    tried = (
        (c, with_candidate(linearisation, c, rest))
        for c in candidates(linearisation, rest, data, problem.seed)
        if c.key not in {one.key, other.key}
    )
    small = ((c, h) for c, h in tried if 0 < h.size - rest.hypothesis.size <= few)
    chosen = list(islice(small, POLICY.merge_candidates))
    return _as_good([(c.key, h) for c, h in chosen], linearisation, node)


def _as_late_as_both(
    pair: tuple[AppliedEffect, AppliedEffect], node: Node, problem: Problem
) -> tuple[EffectKey, Fit] | None:
    """The delay that replaces both, with its fit beside all others; None where it does not fit as well."""
    current, data = node.current, node.data
    one, other = pair
    problem.progress(f"asking whether one delay will do for {one.key} and {other.key}")
    tried = [(h.free[-1].key, h) for h in one_delay_for_two(current.hypothesis, one, other)]
    linearisation = Linearisation.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
    return _as_good(tried, linearisation, node)


def _as_good(
    tried: Sequence[tuple[EffectKey, Hypothesis]], linearisation: Linearisation, node: Node
) -> tuple[EffectKey, Fit] | None:
    """The best of those that explain as much as what was found."""
    current, most = node.current, 1.0 + POLICY.tie
    good = [
        (key, f)
        for (key, _), f in zip(tried, fit([h for _, h in tried], node.data), strict=True)
        if f is not None
        and f.test_loss <= most * current.test_loss
        and f.training_loss <= most * current.training_loss
        and identifiable(linearisation, f)
    ]
    return min(good, key=lambda kf: kf[1].test_loss, default=None)


def _steps(
    found: tuple[EffectKey, Fit], pair: tuple[AppliedEffect, AppliedEffect], node: Node, start: Fit
) -> tuple[AcceptedStep, ...]:
    """The steps as they would have been with that effect where the first of the two was found."""
    (one, fitted), data = found, node.data
    last, gone = converged(fitted, data), {a.key for a in pair}
    instead = [one if step.added in gone else step.added for step in node.steps]
    order = [key for key in dict.fromkeys(instead) if key in last.hypothesis.keys]
    fits = fit([_first(last.hypothesis, order[: k + 1]) for k in range(len(order) - 1)], data)
    known, steps = {step.added: step for step in reversed(node.steps)}, []
    ends = [*(f or last for f in fits), last]
    for own in steps_through(rescored(start, data), zip(order, ends, strict=True), data):
        same = equivalents_at_joint(last.hypothesis.base, own.added)
        told = replace(own, indistinguishable=same, ranking=((own.added, own.removed_share),))
        told, share = known.get(own.added, told), own.removed_share
        steps.append(replace(told, fit=own.fit, data=data, removed_share=share, dropped=(), folds=own.folds))
    return tuple(steps)


def _first(hypothesis: Hypothesis, keys: Sequence[EffectKey]) -> Hypothesis:
    """Only these of its effects."""
    free, parameter_free = (
        tuple(a for a in of if a.key in keys) for of in (hypothesis.free, hypothesis.parameter_free)
    )
    return replace(hypothesis, free=free, parameter_free=parameter_free)
