"""The move that simplifies: it puts special cases in place of refinements and drops effects no longer
needed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

from workbench.core import EffectKey
from workbench.effects import contains, effect_named
from workbench.models import AppliedEffect
from workbench.report.wording import effect_phrase

from ..data import Data
from ..fitting.fit import fit
from ..fitting.refinement import converged, with_candidates
from ..hypothesis import Fit
from ..loss import test_noise_floor
from ..node import Node, rest_without, with_last_step, with_steps
from ..policy import POLICY
from ..problem import Problem
from ..removed_share import removed_share
from ..screening.candidate import Candidate
from ..screening.screen import screen
from ..search_result import AcceptedStep
from ..significance import is_significant, sizes_of


def without_needless(node: Node, problem: Problem) -> Iterator[Node]:
    """Return nodes without an earlier effect that later effects made needless."""
    last = node.steps[-1]
    for step in node.steps[:-1]:
        rest = without(step, node.current, node.data) if step.added != last.added else None
        if rest:
            plain = replace(last, fit=rest, dropped=(*last.dropped, step.added))
            yield with_last_step(node.begun(as_good=True), plain, problem.seed)


def simplified(node: Node, problem: Problem) -> Iterator[Node]:
    """Return nodes in which special cases replace a refinement and fit as well."""
    for step in node.steps:
        last = step is node.steps[-1]
        simple = _simpler(step, node, problem, last=last)
        if not simple:
            continue
        at = node.begun(as_good=True)
        if last:
            simple = (replace(simple[0], dropped=step.dropped), *simple[1:])
            at = replace(at, steps=node.steps[:-1])
        yield with_steps(at, simple, problem.seed)


def _simpler(step: AcceptedStep, node: Node, problem: Problem, *, last: bool) -> tuple[AcceptedStep, ...]:
    """Return steps with special cases in place of a refinement that was chosen early; none if they fit worse.

    The refinement may have fitted the shape of a cause that was found later. One that has two special cases
    may have stood for both, neither of which was enough by itself.

    Args:
        step: the effect in question, as it was found.
        node: with it and all that came later.
        problem: what is searched.
        last: it is the last step, so that its special cases one by one were worse already.

    Returns:
        One or two steps; without their own data and runs.
    """
    current, data = node.current, node.data
    given_up = next((a for a in current.hypothesis.free if a.key == step.added), None)
    special = effect_named(given_up.key.effect).search.contains if given_up else ()
    if given_up is None or len(special) <= last:
        return ()
    problem.progress(f"testing whether a simpler effect can replace {effect_phrase(given_up.key)}")
    bare = rest_without(current, [given_up.key], data)
    if bare is None:
        return ()
    rest, linearisation = bare
    candidates = screen(linearisation, data, rest.hypothesis.free)
    chosen = [c for c in candidates if contains(given_up.key, c.key)]
    for count in (2,) if last else (1, 2):
        sets = list(combinations(chosen, count))
        fits = fit([with_candidates(linearisation, each, rest) for each in sets], data)
        enough = _enough(current.test_loss, rest.test_loss)
        good = [(s, f) for s, f in zip(sets, fits, strict=True) if f is not None and f.test_loss < enough]
        if good:
            best, found = min(good, key=lambda sf: sf[1].test_loss)
            return _steps(step, given_up.key, best, (rest, converged(found, data)), data)
    return ()


def without(step: AcceptedStep, current: Fit, data: Data) -> Fit | None:
    """Return the fit without an effect that became insignificant, or small and useless; None if it is needed.

    An effect that shrank when another was added had mostly stood for that one; its small remainder absorbs
    the model error of the later effect.
    """
    applied = next((a for a in current.hypothesis.free if a.key == step.added), None)
    if applied is None:
        return None
    if not is_significant(applied):
        most = 1.0 + POLICY.simpler_loss
    elif _shrunk(step, applied):
        most = 1.0 + POLICY.tie
    else:
        return None
    (rest,) = fit([current.hypothesis.without(step.added)], data)
    if rest is None:
        return None
    rest = converged(rest, data)
    return (
        rest
        if rest.test_loss < most * current.test_loss and rest.training_loss < most * current.training_loss
        else None
    )


def _shrunk(step: AcceptedStep, applied: AppliedEffect) -> bool:
    """Return whether an effect is much smaller now than in the step that added it."""
    taken = next((a for a in step.fit.hypothesis.free if a.key == step.added), applied)
    sizes = sizes_of(applied)
    return all(
        abs(applied.values[p.name] - p.neutral) < POLICY.shrunk * abs(taken.values[p.name] - p.neutral)
        for p in sizes
    )


def _enough(now: float, without: float) -> float:
    """Return the test loss up to which a simpler model is accepted: a tie, or a small part of what the effect
    explains.
    """
    return max(
        (1.0 + POLICY.tie) * now,
        min((1.0 + POLICY.simpler_loss) * now, now + POLICY.simpler_unseen * (without - now)),
    )


def _steps(
    step: AcceptedStep, given_up: EffectKey, chosen: Sequence[Candidate], fits: tuple[Fit, Fit], data: Data
) -> tuple[AcceptedStep, ...]:
    """Return the steps of the special cases in place of one step; `fits` holds the fit without them and the
    fit with all.
    """
    rest, found = fits
    keys = [c.key for c in chosen]
    # equivalents of the refinement are none of its special case
    twins = effect_named(given_up.effect).search.twins
    indistinguishable = tuple(k for k in step.indistinguishable if k not in keys and k.effect not in twins)
    last = replace(step, added=keys[-1], fit=found, dropped=(given_up,), indistinguishable=indistinguishable)
    if len(keys) == 1:
        return (last,)
    (one,) = fit([found.hypothesis.without(keys[-1])], data)
    if one is None:
        return ()
    floor = test_noise_floor(data)
    shares = [removed_share(a.test_loss, b.test_loss, floor) for a, b in ((rest, one), (one, found))]
    first = replace(last, added=keys[0], fit=one, removed_share=shares[0])
    return first, replace(last, dropped=(), removed_share=shares[1])
