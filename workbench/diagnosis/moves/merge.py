"""The move that merges two effects with many parameters, or two delays, into one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, islice

from workbench.core import EffectKey
from workbench.models import AppliedEffect
from workbench.report.wording import any_of, effect_phrases

from ..fitting.delays import is_delay, one_delay_for_two
from ..fitting.fit import fit
from ..fitting.refinement import converged, with_candidate
from ..hypothesis import Fit, Hypothesis
from ..loss import rescored
from ..node import Node, rest_without, with_steps
from ..policy import POLICY
from ..problem import Problem
from ..screening.compliance import equivalents_at_joint
from ..screening.stiction import candidates
from ..search_result import AcceptedStep, steps_through
from ..significance import identifiable


def merged(node: Node, problem: Problem) -> Iterator[Node]:
    """Return nodes in which one effect, with at most half the parameters, replaces two.

    A payload at the foot changes inertia and weight of the linkage together, and is taken for both while a
    third cause is missing; on two axes that carry it, for a rotor of each. Two delays are merged into one of
    their total length.
    """
    for pair in combinations(node.current.hypothesis.free, 2):
        found = _in_place_of(*pair, node, problem)
        if found is not None:
            root = Node(problem.start, problem.data, as_good=True)
            yield with_steps(root, _steps(found, pair, node, problem.start), problem.seed)


def _in_place_of(one: AppliedEffect, other: AppliedEffect, node: Node, problem: Problem) -> Fit | None:
    """The best fit with one effect (its last) in place of two; None if none is as good as both together."""
    current, data, most = node.current, node.data, 1.0 + POLICY.tie
    delays = is_delay(one.key) and is_delay(other.key)
    alike = one.key.effect == other.key.effect
    if not (delays or alike) and len(one.parameters) + len(other.parameters) < POLICY.merge_from:
        return None
    kind, two = "delay" if delays else "cause", any_of(effect_phrases([one.key, other.key]), "and")
    problem.progress(f"testing whether one {kind} can replace {two}")
    bare = rest_without(current, [one.key, other.key], data)
    if bare is None:
        return None
    rest, linearisation = bare
    least = rest.hypothesis.size
    if delays:
        tried = one_delay_for_two(current.hypothesis, one, other)
    else:
        known = candidates(linearisation, rest, data, problem.seed)
        others = (c for c in known if c.key not in {one.key, other.key})
        few = POLICY.merge_size * (current.hypothesis.size - least)
        added = (with_candidate(linearisation, c, rest) for c in others)
        tried = list(islice((h for h in added if 0 < h.size - least <= few), POLICY.merge_candidates))
    good = [
        f
        for f in fit(tried, data)
        if f is not None
        and f.test_loss <= most * current.test_loss
        and f.training_loss <= most * current.training_loss
        and identifiable(linearisation, f)
    ]
    return min(good, key=lambda f: f.test_loss, default=None)


def _steps(
    found: Fit, pair: tuple[AppliedEffect, AppliedEffect], node: Node, start: Fit
) -> tuple[AcceptedStep, ...]:
    """Return the steps as if the last effect of a fit had been found where the first of the two was."""
    one, data = found.hypothesis.free[-1].key, node.data
    last, gone = converged(found, data), {a.key for a in pair}
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
    """Return a fit with only the first of its effects."""
    free, parameter_free = (
        tuple(a for a in of if a.key in keys) for of in (hypothesis.free, hypothesis.parameter_free)
    )
    return replace(hypothesis, free=free, parameter_free=parameter_free)
