"""From a search to a verdict: what is missing, how certain that is, what else it could be, what to measure
next.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import prod
from pathlib import Path

import numpy as np

from workbench.comparison import softness_note
from workbench.core import Diagnosis, EffectKey, Finding, Verdict
from workbench.effects import SETTINGS, OfBody, effect_named, link_of, load_model
from workbench.models import Model, springs
from workbench.recordings import Source, load_recordings

from .acceptance import contradicts_holdout
from .checks.units import doubted, state_units
from .evidence.linkage_weight import BIAS, weights_like
from .evidence.next_experiment import next_experiment
from .evidence.residual_evidence import ResidualEvidence
from .findings import (
    by_links_line,
    cut_short_line,
    findings_of,
    near_findings,
    near_line,
    ranking_of,
    refuting_line,
)
from .loss import rescored
from .mend import mend_lines, mend_recordings
from .policy import POLICY
from .problem import Progress
from .rounds import Rounds, comparisons, part_of, rounds
from .search_result import SearchResult
from .verdict import NAMED, verdict_of

_NO_PAYLOAD = (
    "no payload was searched for, because the model has no site for one; add a site at the end of the "
    "last link, or name a site in [payload]"
)
_CARRIED = (
    "the transmission changes with the posture: effects at the drives, and masses of the links that the "
    "joints move, were searched for; lengths, masses of cranks and rods, and friction, springs and gaps "
    "behind the drives were not"
)
_RESTS = (
    "the torque bias on {} may instead be a wrong rest position of the model's spring there: {:.3g} from the "
    "file's value, in the drive's coordinate"
)
_WEIGHT = "the torque bias on {} may instead come from a crank or rod with another mass or centre of mass"


def diagnose(
    model: Model | str | Path,
    training: Source | Iterable[Source],
    held_out: Source | Iterable[Source] = (),
    *,
    seed: int = 0,
    progress: Progress = lambda text: None,
) -> Diagnosis:
    """Return the physical effects that are missing from a model: which, how large, and how sure.

    Args:
        model: what we believe, or its file or name.
        training: recordings to fit, one or several, or their files.
        held_out: recordings that only test the fit; without them, folds of the training data do.
        seed: of the noise simulations.
        progress: told what is being done.

    Raises:
        InputError: a file that cannot be read, no recording, or recordings that do not fit the model, or that
            show neither loop nor torque.
        SimulationError: the model is unstable in a recording's loop.
    """
    model, training = load_model(model), load_recordings(training, some=True)
    return diagnosis_of(rounds(model, training, load_recordings(held_out), seed, progress))


def diagnosis_of(found: Rounds) -> Diagnosis:
    """Return the diagnosis that follows from one search or several successive ones."""
    first, last = found[0], found[-1]
    verdict = verdict_of(first)
    named = verdict in NAMED
    rest = _rest(verdict, found)
    if len(found) > 1:
        whole = last.consistent_after or rest <= 1.0 - POLICY.explained
        verdict = "missing_effect" if whole else "partly_explained"
    before, *holdout_before = comparisons(first.model, first.start_runs, first)
    after, *holdout_after = before, *holdout_before
    if named and last.steps[-1].runs is not None:
        after, *holdout_after = comparisons(last.final.hypothesis.model, last.steps[-1].runs, last)
    judging = last.final_data if named else first.start_data
    held_out_floor = judging.score(judging.floor, held_out=True) if judging.held_out else None
    each = [(f, findings_of(f, held_out_floor)) for f in found] if named else []
    recordings = first.start_data.recordings
    findings = doubted(tuple(finding for _, own in each for finding in own), recordings)
    ends = [(replace(f, consistent_after=last.consistent_after), own) for f, own in each or [(first, ())]]
    advice = (next_experiment(verdict, own, f, after) for f, own in ends)
    clues = _evidence_of_rest(verdict, last)
    return Diagnosis(
        model=first.model.name,
        verdict=verdict,
        error=before.error,
        noise_error=(after if named else before).noise_error,
        findings=findings,
        unexplained_fraction=rest,
        where=after.where,
        next_experiment=state_units(first.disagreeing) or next((a for a in advice if a), None),
        not_excited=_not_excited(first, findings),
        ranking=ranking_of(first),
        evidence=(
            *refuting_line(verdict, first),
            *near_line(verdict, first),
            *cut_short_line(last),
            *by_links_line(last),
            *(clues.of_rest(after.where) if clues else ()),
        ),
        shapes=clues.shapes if clues else (),
        before=before,
        after=after,
        held_out=(holdout_before[0], holdout_after[0]) if holdout_before else None,
        settled=_model_settings(first) if named else {},
        holdout_noise_error=held_out_floor,
        near=near_findings(last),
        stopped=last.stopped,
        work=sum(f.start_data.budget.done for f in found),
        identifiability=first.identifiability,
        disagreeing=first.disagreeing,
        trace=first.trace,
        mend=mend_lines(first.model, recordings, findings),
        mend_recordings=mend_recordings(first.model, recordings, findings),
        by_links=last.by_links if last.of_links else 0.0,
        notes=(
            *before.notes,
            *_softness(first),
            *_bodies(findings, first.model),
            *_resting(findings, first.model),
            *(_parting(last) if named else ()),
            *_not_looked_for(verdict, findings, first),
        ),
    )


def _not_excited(found: SearchResult, findings: Sequence[Finding]) -> tuple[EffectKey, ...]:
    """Return the effects that these data could not have shown.

    A small one may show nothing where a large one does as well as a finding: that is told beside the finding.
    """
    if found.identifiability is None:
        return ()
    rivals = {key for f in findings for key in f.indistinguishable_from}
    return tuple(key for key in found.identifiability.not_excited if key not in rivals)


def _bodies(findings: Sequence[Finding], model: Model) -> tuple[str, ...]:
    """Return lines that name the body of a link where the axis has another name than its joint."""
    keys = [f.key for f in findings if isinstance(effect_named(f.key.effect).corrects, OfBody)]
    links = {key.axis: link_of(model, key.axis) for key in keys}
    joints = dict(zip(model.axes, model.links[1], strict=True))
    return tuple(
        f"the {axis} link is the body '{link.body}', which joint '{joints[axis]}' moves"
        for axis, link in links.items()
        if link is not None and axis is not None and joints[axis] != axis
    )


def _resting(findings: Sequence[Finding], model: Model) -> tuple[str, ...]:
    """Return lines that say a constant torque may come from a spring of the model file with another rest
    position.
    """
    constant = [f for f in findings if f.key.effect == BIAS]
    stiff = dict(zip(model.axes, springs(model), strict=True)) if constant else {}
    return tuple(
        _RESTS.format(f.key.axis, f.parameters["torque"].value / stiff[f.key.axis])
        for f in constant
        if f.key.axis and stiff[f.key.axis]
    )


def _not_looked_for(verdict: Verdict, findings: Sequence[Finding], found: SearchResult) -> tuple[str, ...]:
    model = found.model
    payload = (_NO_PAYLOAD,) if verdict != "consistent" and model.payload_site is None else ()
    if model.carried is None:
        return payload
    constant = [f.key.axis for f in findings if f.key.effect == BIAS]
    bodies = f": {' or '.join(map(str, weights_like(found)))}".removesuffix(": ")
    return (_CARRIED, *(_WEIGHT.format(axis) + bodies for axis in constant), *payload)


def _rest(verdict: Verdict, found: Rounds) -> float:
    """Return the share of the squared error above the noise that remains after everything that was named."""
    if verdict == "consistent":
        return 0.0
    return float(prod(map(_left, found))) if verdict in NAMED else 1.0


def _left(found: SearchResult) -> float:
    """Return that share after one search; zero if noise explains the rest and held-out motion agrees.

    Of an error that was hardly above the noise a share says only how noise fell.
    """
    objects = contradicts_holdout(rescored(found.final, found.final_data), found.final_data)
    return 0.0 if found.consistent_after and not objects else 1.0 - found.explained


def _softness(found: SearchResult) -> tuple[str, ...]:
    data = found.start_data
    fitted = data.replay.only(range(data.training))
    note = softness_note(found.model, fitted, part_of(found.start_runs, slice(0, data.training)))
    return () if note is None else (note,)


def _parting(found: SearchResult) -> tuple[str, ...]:
    """Return a line on the extra error floor when trajectories of equally good models diverge."""
    data = found.final_data
    own, noise = data.score(data.floor), data.score(np.mean(data.noise_squares, axis=0))
    if not found.final.hypothesis.diverges or own < POLICY.noise_slack * noise:
        return ()
    return (
        f"with a gap, trajectories diverge for small parameter changes: an error of {own:.3g} does not "
        f"show that anything is missing, although noise alone gives {noise:.3g}",
    )


def _model_settings(found: SearchResult) -> dict[str, float]:
    """Return the model settings that were fitted together with the findings and changed."""
    given, end = found.model, found.final.hypothesis.model
    pairs = {s.name: (s.get(given), s.get(end)) for s in SETTINGS}
    return {name: float(new) for name, (old, new) in pairs.items() if new != old}


def _evidence_of_rest(verdict: Verdict, found: SearchResult) -> ResidualEvidence | None:
    """Return the evidence on the part that stays unexplained; None if noise explains it."""
    named = verdict in NAMED
    if found.consistent_before or (named and found.consistent_after):
        return None
    return ResidualEvidence(found.start_data, found.final if named else found.start)
