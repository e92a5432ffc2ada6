"""The move that replaces an effect which was chosen while other causes were still missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.report.wording import effect_phrase

from ..acceptance import halves_excess, near_noise_floor
from ..fitting.fit import fit
from ..fitting.refinement import converged, with_candidate
from ..hypothesis import Fit
from ..loss import test_noise_floor
from ..node import Growth, Node, rest_without, with_steps
from ..policy import POLICY
from ..problem import Problem
from ..removed_share import removed_shares
from ..screening.compliance import compliance_candidates, equivalents_at_joint
from ..screening.stiction import candidates
from ..search_result import AcceptedStep, has_cause
from ..significance import identifiable
from .choice import EffectLoss, Explanation, loss_ratios


def replaced(node: Node, problem: Problem) -> Iterator[Node]:
    """Return nodes with one effect replaced by another of nearly the same loss, starting with the last
    effects; or by itself, where a fit from a new start leaves as little as another.

    While a delay is missing, a spring in the joint is taken for one at the drive: they can be distinguished
    only once all other causes are in the model. A replacement of the last effect may need one more effect.
    """
    for step in reversed(node.steps):
        found = _replacements(step, node, problem)
        if found and halves_excess(found[0].fit, node.current, node.data):
            yield with_steps(node.begun(growth=Growth()), found[:1], problem.seed)
        elif step is node.steps[-1] and not near_noise_floor(node.current, node.data):
            for each in (f for f in found if f.added != step.added):
                yield with_steps(node.begun(growth=Growth(most=1)), (each,), problem.seed)


def _replacements(step: AcceptedStep, node: Node, problem: Problem) -> tuple[AcceptedStep, ...]:
    """Return steps with one effect replaced by another and all others kept, best first.

    The effect itself starts anew beside them, and stays where it does as well: none wins by a new start.
    """
    keys = [key for key, left in step.loss_ratios if left < POLICY.replacement_close]
    rest, tried = _in_its_place(step, keys, node, problem, itself=True)
    if rest is None:
        return ()
    most = (1.0 + POLICY.tie) * min((f.test_loss for _, f in tried), default=0.0)
    tried = sorted(tried, key=lambda cf: cf[0].key != step.added or cf[1].test_loss > most)
    left = [(c.key, f.test_loss) for c, f in tried]
    if step.added not in dict(left):
        left.append((step.added, node.current.test_loss))
    return tuple(_step(explanation, left, step, rest, node) for explanation in tried)


def with_rivals_beside_all(node: Node, problem: Problem) -> Node:
    """Return the node with the rivals of each effect fitted beside all effects that were added later.

    What did as well while a delay was missing need not do so beside the delay. Only asked where noise is all
    that is left: where more is missing, a rival may explain a part of that.
    """
    if not node.done or node.jointly or node.diverges or node.data.budget.spent:
        return node
    steps = tuple(_beside_all(step, node, problem) for step in node.steps[:-1])
    return replace(node, steps=(*steps, *node.steps[-1:]))


def _beside_all(step: AcceptedStep, node: Node, problem: Problem) -> AcceptedStep:
    """Return the step with loss ratios of its closest rivals beside all effects."""
    close = [key for key, left in step.loss_ratios if left < POLICY.pair_rival]
    rest, tried = _in_its_place(step, close, node, problem)
    if rest is None:
        return step
    left = dict(loss_ratios(step.added, node.current.test_loss, ((c.key, f.test_loss) for c, f in tried)))
    ratios = {**dict(step.loss_ratios), **left}
    return replace(
        step,
        loss_ratios=tuple(sorted(ratios.items(), key=lambda r: r[1])),
        indistinguishable=tuple(k for k in step.indistinguishable if left.get(k, 1.0) <= 1.0 + POLICY.tie),
    )


def _in_its_place(
    step: AcceptedStep, keys: Sequence[EffectKey], node: Node, problem: Problem, *, itself: bool = False
) -> tuple[Fit | None, list[Explanation]]:
    """Return the fit without the effect of a step, and fits with some others (or `itself`) in its place, best
    first.

    Causes that the node has already are not tried. None and nothing where there is nothing to try.
    """
    current, data = node.current, node.data
    keys = [key for key in keys if not has_cause(current, key)]
    if not keys or all(a.key != step.added for a in current.hypothesis.free):
        return None, []
    problem.progress(f"trying other causes in place of {effect_phrase(step.added)}")
    bare = rest_without(current, [step.added], data)
    if bare is None:
        return None, []
    rest, linearisation = bare
    known = (
        *candidates(linearisation, rest, data, problem.seed),
        *compliance_candidates(linearisation, rest.test_loss, rest.hypothesis.free),
    )
    chosen = [c for key in keys for c in known if c.key == key][: POLICY.replacements]
    chosen += [c for c in known if c.key == step.added and itself]
    fits = fit([with_candidate(linearisation, c, rest) for c in chosen], data)
    tried = [
        (c, f) for c, f in zip(chosen, fits, strict=True) if f is not None and identifiable(linearisation, f)
    ]
    return rest, sorted(tried, key=lambda cf: cf[1].test_loss)


def _step(
    explanation: Explanation, left: Sequence[EffectLoss], step: AcceptedStep, rest: Fit, node: Node
) -> AcceptedStep:
    """Return the step of one replacement; `left` holds the test loss of each candidate."""
    (candidate, found), data = explanation, node.data
    found = converged(found, data)
    alike = [key for key, test_loss in left if test_loss <= found.test_loss * (1.0 + POLICY.tie)]
    pins = equivalents_at_joint(node.current.hypothesis.base, candidate.key)
    return replace(
        AcceptedStep.between(rest, found, candidate.key, data),
        folds=(int(np.sum(found.fold_losses < node.current.fold_losses)), len(found.fold_losses)),
        indistinguishable=tuple(dict.fromkeys(key for key in (*alike, *pins) if key != candidate.key)),
        dropped=tuple(key for key in (step.added,) if key != candidate.key),
        ranking=removed_shares(rest.test_loss, left, test_noise_floor(data)),
        loss_ratios=loss_ratios(candidate.key, found.test_loss, left),
    )
