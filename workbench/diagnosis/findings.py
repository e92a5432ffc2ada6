"""Findings and steps of a search: estimates, probabilities, indistinguishable effects, near findings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from workbench.core import EffectKey, Finding, Step, Verdict
from workbench.core.units import unit_text
from workbench.effects import effect_named, model_value
from workbench.models import AppliedEffect, Model, Placement
from workbench.report.wording import effect_phrase

from .evidence.linkage_weight import BIAS, weights_like
from .evidence.residual_evidence import ResidualEvidence, adequacy_lines, finding_lines
from .hypothesis import Fit
from .loss import test_noise_floor
from .naming import link_instead
from .policy import POLICY
from .removed_share import HeldOutFall, removed_share
from .screening.compliance import other_causes
from .screening.identifiability import inseparable
from .search_result import AcceptedStep, SearchResult, has_cause
from .significance import is_significant


def findings_of(found: SearchResult, held_out_floor: float | None) -> tuple[Finding, ...]:
    """Return findings of the final model; the effect that explains most comes first.

    `held_out_floor` is the noise floor of held-out recordings that is told beside their errors; None where
    there are none.
    """
    findings, weights = [], weights_like(found)
    keys = found.final.hypothesis.keys
    for applied in found.final.hypothesis.added:
        index = next(k for k, s in enumerate(found.steps) if s.added == applied.key)
        step, previous = found.steps[index], _before(found, index)
        fall = _held_out_fall(found, index, held_out_floor)
        same = inseparable(found.linear, applied, found.model) if found.linear else ()
        rivals = dict.fromkeys(
            (
                *step.indistinguishable_at(found.final),
                *(k for k in same if k not in keys),
                *link_instead(found.model, applied),
            )
        )
        findings.append(
            Finding(
                key=applied.key,
                parameters=dict(applied.parameters),
                error_after=found.start_data.score(step.fit.mean_squares),
                holdout_error_before=fall and fall.before,
                holdout_error_after=fall and fall.after,
                probability=_probability(step, found, rivals, len(weights) * (applied.key.effect == BIAS)),
                indistinguishable_from=tuple(rivals),
                evidence=(
                    *finding_lines(step, applied, keys, fall),
                    *adequacy_lines(applied.key, found.adequacy),
                    *ResidualEvidence(found.start_data, previous).of_finding(applied.key),
                ),
                **_corrected(found.model, applied),
            )
        )
    return tuple(findings)


def near_findings(found: SearchResult) -> tuple[Finding, ...]:
    """Return effects that lower the error beside the findings but are not certain enough to be named."""
    score = found.start_data.score
    on_holdout = found.start_data.held_out
    after = score(found.final.mean_squares, held_out=True) if on_holdout else None
    return tuple(
        Finding(a.key, dict(a.parameters), score(found.final.mean_squares), after, None, 0.0)
        for a in found.near
    )


def _corrected(model: Model, applied: AppliedEffect) -> dict[str, Any]:
    """Return the number of the model that an effect corrects: its old and its new value."""
    effect = effect_named(applied.key.effect)
    own = model_value(effect, model, Placement.of(model, applied.key), applied.values)
    number = effect.corrects and effect.corrects.told_by(applied.values)
    if number is None or own is None:
        return {"number": number.called if number else ""}
    more = applied.parameters[number.parameter]
    return {"number": number.called, "model_value": own, "total": replace(more, value=own + more.value)}


def _held_out_fall(found: SearchResult, index: int, floor: float | None) -> HeldOutFall | None:
    """Return held-out errors before and after a step; None if there are no held-out recordings."""
    if floor is None:
        return None
    fits = (_before(found, index), found.steps[index].fit)
    before, after = (found.start_data.score(f.mean_squares, held_out=True) for f in fits)
    return HeldOutFall(before, after, floor)


def _before(found: SearchResult, index: int) -> Fit:
    """Return the fit before a step added its effect.

    That is the previous fit; if that had a refinement of which this step has a part, the last fit without it.
    """
    fits = [found.start, *(step.fit for step in found.steps)]
    step = found.steps[index]
    if fits[index].test_loss > step.fit.test_loss:
        return fits[index]
    own = step.fit.hypothesis.keys - {step.added}
    return next(f for f in reversed(fits[: index + 1]) if own >= f.hypothesis.keys)


def _probability(
    step: AcceptedStep, found: SearchResult, rivals: Iterable[EffectKey], more: int = 0
) -> float:
    """Return the probability that the name is right, from the next loss ratio and the unexplained share.

    An explanation 10 % worse leaves about a fifth to doubt. Of those that do as well the simplest is named,
    which is more often the true one: a lone rival takes a fifth of the chance, three take two thirds (in
    `benchmarks/hidden_effects.py` 8 of 9 names with one rival were true, 1 of 5 with more). What counts as
    a rival does not count as the next explanation besides. `more` rivals are no effects.
    """
    indistinguishable = other_causes(found.model, step.added, rivals)
    others = (
        left
        for key, left in step.loss_ratios
        if key not in indistinguishable and not has_cause(found.final, key)
    )
    next_best = min(others, default=np.inf)
    close = float(np.exp(-POLICY.next_best_decay * max(next_best - 1.0, 0.0)))
    alone = 1.0 - POLICY.next_best_doubt * close
    sure = found.adequacy.get(step.added)
    whole = 1.0 if found.consistent_after else sure.share if sure else found.explained
    # beside one effect of the whole machine, the same on each of its drives is one rival
    whole_machine = step.added.axis is None
    causes = {key.effect if whole_machine else key for key in indistinguishable}
    doubt = POLICY.rival_doubt * (len(causes) + more) ** 2
    return float(min(alone, POLICY.surest) * whole / (1.0 + doubt))


def ranking_of(found: SearchResult) -> tuple[tuple[EffectKey, float], ...]:
    """Return the `removed_share` of each effect by itself: simulated if available, otherwise as screened."""
    if found.consistent_before or not found.screened:
        return ()
    simulated = found.steps[0].ranking if found.steps else ()
    done = {key for key, _ in simulated}
    start, floor = found.start.test_loss, test_noise_floor(found.start_data)
    rest = [
        (c.key, float(np.clip(removed_share(start, c.test_loss, floor), 0.0, 1.0)))
        for c in found.screened
        if c.key not in done
    ]
    return tuple(sorted((*simulated, *rest), key=lambda r: -r[1])[:12])


def step_of(
    index: int,
    found: SearchResult,
    held_out_floor: float | None,
    evidence: Mapping[EffectKey, tuple[str, ...]],
) -> Step:
    """Return an accepted step as one of an improvement, with the evidence of its finding if there is one.

    Errors are those of the model at that step; parameters those of the last model, where it still has the
    effect.
    """
    step, fall = found.steps[index], _held_out_fall(found, index, held_out_floor)
    added = (*found.final.hypothesis.added, *step.fit.hypothesis.added)
    applied = next(a for a in added if a.key == step.added)
    return Step(
        key=step.added,
        parameters=dict(applied.parameters),
        error=found.start_data.score(step.fit.mean_squares),
        holdout_error=fall and fall.after,
        indistinguishable_from=step.indistinguishable_at(found.final),
        evidence=evidence.get(step.added) or finding_lines(step, applied, held_out=fall),
        removed=step.dropped,
    )


def near_line(verdict: Verdict, found: SearchResult) -> tuple[str, ...]:
    """Return a line on the effect that removes most of the excess but not enough to be named.

    Below a limit only the existence of a partial explanation is reported.
    """
    added = found.final.hypothesis.added
    if verdict != "unexplained" or found.explained < POLICY.something or not all(map(is_significant, added)):
        return ()
    both = found.start_data.tests_on_holdout
    data = "both the fitted and the held-out recordings" if both else "the fitted recordings"
    if found.explained < POLICY.near_named:
        return (
            f"known effects explain {100 * found.explained:.0f} % of the squared error above the noise on "
            f"{data}, not enough to name one; improve --nearest adds them",
        )
    # cut, not rounded: what is not enough must not read as if it were
    share = f"{int(100 * found.explained)} % of the squared error above the noise"
    them = "it removes" if len(added) == 1 else "together they remove"
    return (
        f"nearest, but not enough to be named: {' and '.join(map(_estimated, added))}; {them} {share} on "
        f"{data}",
    )


def refuting_line(verdict: Verdict, found: SearchResult) -> tuple[str, ...]:
    """Return a line on held-out recordings that contradict the training recordings."""
    data = found.start_data
    if verdict != "unexplained" or not found.consistent_before:
        return ()
    error, floor = (data.score(ms, held_out=True) for ms in (found.start.mean_squares, data.floor))
    return (
        f"the fitted recordings show nothing missing, but the held-out ones do: error {error:.3g}, "
        f"{error / floor:.1f} times the noise; fit those and hold out others",
    )


def _estimated(applied: AppliedEffect) -> str:
    values = (
        f"{name} {e.value:.3g} ± {2 * e.std:.2g} {unit_text(e.unit)}".strip()
        for name, e in applied.parameters.items()
    )
    return f"{effect_phrase(applied.key)} ({', '.join(values)})"


def cut_short_line(found: SearchResult) -> tuple[str, ...]:
    """Return a line that more may be missing, if the search ended because its work budget was spent."""
    if found.stopped != "budget":
        return ()
    return (
        "the search reached its simulation limit before every candidate was tried, so more effects may "
        "be missing; to search further, give fewer or shorter recordings, or diagnose the model that "
        "`improve` writes",
    )


def by_links_line(found: SearchResult) -> tuple[str, ...]:
    """Return a line on errors of all links, where these together explain most of what is left."""
    if not found.by_links:
        return ()
    return (
        "new masses, centres of mass and inertias of all links together explain "
        f"{100.0 * found.by_links:.0f} % of the remaining torque on data that were not fitted: the model's "
        "numbers may be guesses; 'workbench identify links' fits all of them",
    )
