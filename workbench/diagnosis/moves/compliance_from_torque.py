"""A compliance accepted from the inverse-dynamics residual, without closed-loop confirmation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.effects import effect_named, kinds
from workbench.report.wording import effect_phrase

from ..data import Data
from ..fitting.fit import fit
from ..fitting.refinement import with_candidates
from ..hypothesis import Fit, Hypothesis, applied_effect
from ..node import Node, linearisation_at
from ..problem import Problem
from ..screening.candidate import Candidate
from ..screening.compliance import compliance_candidates, equivalents_at_joint
from ..screening.sensitivity import Linearisation
from ..search_result import AcceptedStep, steps_through
from ..significance import identifiable
from .beside_backlash import beside_backlash
from .choice import loss_ratios

_ROUNDS = 12  # of a fit of backlash with others: derivatives of diverging trajectories are rough
_FEW = 3  # iterations of an intermediate fit


def compliance_from_torque(at: Node, problem: Problem, most: float = 1.0) -> tuple[AcceptedStep, ...]:
    """Return steps with the spring or backlash that explains most of the inverse-dynamics residual; otherwise
    none.

    The closed loop does not follow the measurement while anything else is missing, least of all with
    backlash, whose trajectories diverge: no simulation confirms it by itself. Effects that are missing beside
    backlash come with it.

    Args:
        at: the model so far.
        problem: what is searched.
        most: share of the residual torque that it may leave.

    Returns:
        One step an effect, without its own data and runs; none where no compliance explains enough.
    """
    data, start, linearisation = at.data, at.current, linearisation_at(at.current, at.data, problem)
    known = compliance_candidates(linearisation, 1.0, start.hypothesis.free)
    if not known or known[0].test_loss > most:
        return ()
    plain, *others = known
    problem.progress(f"starting from {effect_phrase(plain.key)}, which the torque suggests")
    chosen = [plain]
    if kinds.diverges(effect_named(plain.key.effect)):
        chosen = beside_backlash(linearisation, plain, start)
    fits = _fits(linearisation, chosen, start, data)
    if fits is None or not identifiable(linearisation, fits[-1]):
        return ()
    close = loss_ratios(plain.key, plain.test_loss, ((c.key, c.test_loss) for c in others))
    steps = steps_through(start, zip((c.key for c in chosen), fits, strict=True), data)
    return tuple(
        replace(
            step,
            indistinguishable=equivalents_at_joint(linearisation.model, step.added),
            ranking=((step.added, step.removed_share),),  # losses of others are not of this kind
            loss_ratios=() if k else close,
        )
        for k, step in enumerate(steps)
    )


def _fits(
    linearisation: Linearisation, chosen: Sequence[Candidate], start: Fit, data: Data
) -> list[Fit] | None:
    """Return fits of the first candidate, the first two, and so on; None if the model with all of them fails
    to run.
    """
    fits: list[Fit | None] = []
    before = start
    rounds = (*(_FEW for _ in chosen[1:]), _ROUNDS) if len(chosen) > 1 else (1,)
    for k, most in enumerate(rounds):
        hypothesis = _with_unseen(with_candidates(linearisation, chosen[: k + 1], start), before)
        fits += fit([hypothesis], data, most)
        before = fits[-1] or before
    last = fits[-1]
    # an intermediate loop may not run although the final one does
    return None if last is None else [f or last for f in fits]


def _with_unseen(hypothesis: Hypothesis, before: Fit) -> Hypothesis:
    """Values of an earlier fit where the torque says nothing about the gap and there are no values yet."""
    known = {a.key: a.values for a in before.hypothesis.free}
    free = []
    for applied in hypothesis.free:
        earlier = known.get(applied.key, {})
        values = {name: value or earlier.get(name, value) for name, value in applied.values.items()}
        free.append(applied_effect(hypothesis.base, applied, values))
    return replace(hypothesis, free=tuple(free))
