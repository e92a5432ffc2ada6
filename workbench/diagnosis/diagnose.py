"""From a search to a verdict: what is missing, how sure, what else it could be, what to measure next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import Simulated, evaluate, followed, matched, softness_note
from workbench.core import (
    Comparison,
    Diagnosis,
    Improvement,
    InputError,
    Recording,
    Verdict,
)
from workbench.models import Model
from workbench.simulation import scored_torque

from .data import Data
from .evidence import Clues
from .findings import (
    NEAR,
    cut_short_line,
    findings_of,
    near_findings,
    near_line,
    ranking_of,
    refuting_line,
    step_of,
)
from .loops import refuse_coordinates
from .mirrored import refuse_turned
from .next_experiment import next_experiment
from .search import LIMIT, Progress, UnstableLoop, search
from .stage import Search
from .units import doubted, refuse_unit
from .verdict import NAMED, refuted, verdict_of

_FEWEST = 60  # rows to fit; a log of 5 Hz has them in twelve seconds
_SHOWN = 3.0  # deviations at which an effect of 2 % of the torque counts as excited
_UNSTABLE = "The model is unstable in the loop"
_NO_PAYLOAD = (
    "a payload was not looked for: the model names no place for one; add a site where the machine ends, or "
    "name one in [payload]"
)


def diagnose(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    *,
    seed: int = 0,
    progress: Progress = lambda text: None,
) -> Diagnosis:
    """Which physical effects are missing from a model.

    Args:
        model: what we believe.
        training: recordings to fit.
        held_out: recordings that judge; without them, folds of the training data do.
        seed: of the noise simulations.
        progress: told what is being done.

    Raises:
        InputError: recordings that do not fit the model, or that show neither loop nor torque.
        SimulationError: the model is unstable in a recording's loop.
    """
    training, held_out = _matched(model, training, held_out)
    return _diagnosis(_searched(model, training, held_out, seed, LIMIT, progress))


def improve(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    *,
    seed: int = 0,
    limit: int = LIMIT,
    nearest: bool = False,
    progress: Progress = lambda text: None,
) -> tuple[Improvement, Model]:
    """Diagnose and add until the data are explained.

    Args:
        model: what we believe.
        training: recordings to fit.
        held_out: recordings that judge.
        seed: of the noise simulations.
        progress: told what is being done.
        limit: most effects to add one by one.
        nearest: where no cause can be named, add what lowers the error on data that were not fitted all the
            same. The verdict stays ``unexplained``.

    Returns:
        The steps with their errors, and the improved model; the model as given where nothing is added.

    Raises:
        InputError, SimulationError: as `diagnose`.
    """
    training, held_out = _matched(model, training, held_out)
    found = _searched(model, training, held_out, seed, limit, progress)
    diagnosis = _diagnosis(found)
    named = diagnosis.verdict in NAMED
    stages = found.stages if named or (nearest and not refuted(found)) else ()
    end = found.final if stages else found.start
    after, held = diagnosis.after, diagnosis.held_out
    if stages and not named and stages[-1].runs is not None:
        after, *judging = _comparisons(end.hypothesis.model, stages[-1].runs, found)
        held = (held[0], judging[0]) if held else None
    data = found.start_data
    judged = data.held_out
    evidence = {f.key: f.evidence for f in diagnosis.findings}
    done = found.consistent_after if named else diagnosis.verdict == "consistent"
    verdict: Verdict = "consistent" if done else "unexplained"
    verdict = "partly_explained" if diagnosis.verdict == "partly_explained" else verdict
    improvement = Improvement(
        model=model.name,
        steps=tuple(step_of(s, found, judged, evidence) for s in stages),
        error_before=data.score(found.start.mean_squares),
        error_after=data.score(end.mean_squares),
        holdout_error_before=data.score(found.start.mean_squares, held_out=True) if judged else None,
        holdout_error_after=data.score(end.mean_squares, held_out=True) if judged else None,
        noise_error=after.noise_error if after else diagnosis.noise_error,
        verdict=verdict,
        before=diagnosis.before,
        after=after,
        held_out=held,
        diagnosis=diagnosis,
        holdout_noise_error=diagnosis.holdout_noise_error,
        notes=diagnosis.notes,
        nearest=bool(stages) and not named,
    )
    better = end.hypothesis.model
    ending = "improved" if named else "nearest"
    return improvement, replace(better, name=f"{model.name}_{ending}") if stages else model


def _searched(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording],
    seed: int,
    limit: int,
    progress: Progress,
) -> Search:
    """What was found in the loops; where the model cannot run in them, along the measured motion.

    The friction and the rotors that a model lacks may be what keeps the machine's loop stable. The torque
    shows them, and only then is their lack an answer: else the loop that cannot be run remains the news.
    """
    try:
        return search(model, training, held_out, seed=seed, limit=limit, progress=progress)
    except UnstableLoop:
        every = (*training, *held_out)
        if any(scored_torque(r) is None for r in every):
            raise
        along, judging = followed(training, _UNSTABLE), followed(held_out, _UNSTABLE)
        found = search(model, along, judging, seed=seed, limit=limit, progress=progress)
        if not found.consistent_before and max(found.explained, found.mostly) < NEAR:
            raise
        return found


def _matched(
    model: Model, training: Sequence[Recording], held_out: Sequence[Recording]
) -> tuple[tuple[Recording, ...], tuple[Recording, ...]]:
    every = matched(model, (*training, *held_out))
    fitted, judging = every[: len(training)], every[len(training) :]
    rows = sum(int(r.valid.sum()) for r in fitted)
    if rows < _FEWEST:
        raise InputError(
            f"{rows} rows are too few to tell one effect from another", file=fitted[0].source,
            remedy=f"record for longer, {_FEWEST} rows at least and seconds of motion",
        )  # fmt: skip
    if all(np.ptp(r.position[r.valid], axis=0).max() == 0.0 for r in fitted):
        raise InputError(
            "no axis moves in these recordings", file=fitted[0].source,
            remedy="record some motion: what stands still shows no effect",
        )  # fmt: skip
    refuse_coordinates(model, (*fitted, *judging))
    refuse_unit(model, fitted)
    refuse_turned(model, fitted)
    return fitted, judging


def _diagnosis(found: Search) -> Diagnosis:
    verdict, less = verdict_of(found)
    named = verdict in NAMED
    before, *judging = _comparisons(found.model, found.start_runs, found)
    after, *judged = before, *judging
    if named and found.stages[-1].runs is not None:
        after, *judged = _comparisons(found.final.hypothesis.model, found.stages[-1].runs, found)
    findings = doubted(findings_of(found), found.start_data.recordings) if named else ()
    rest = 0.0 if verdict == "consistent" else 1.0 - (found.explained if named else 0.0)
    if named and found.consistent_after:
        rest = min(rest, 1.0 - found.explained)
    clues = _clues_of_rest(verdict, found)
    return Diagnosis(
        model=found.model.name,
        verdict=verdict,
        error=before.error,
        noise_error=(after if named else before).noise_error,
        findings=findings,
        unexplained_fraction=float(rest),
        where=after.where,
        next_experiment=next_experiment(verdict, findings, found, after),
        not_excited=tuple(c.key for c in found.screened if c.detectable < _SHOWN),
        ranking=ranking_of(found),
        evidence=(
            *refuting_line(verdict, found),
            *(less.lines if less and not named else ()),
            *near_line(verdict, found),
            *cut_short_line(found),
            *(clues.of_rest(after.where) if clues else ()),
        ),
        shapes=clues.shapes if clues else (),
        before=before,
        after=after,
        held_out=(judging[0], judged[0]) if judging else None,
        settled=_settled(found) if named else {},
        holdout_noise_error=_held_out_floor(found.final_data if named else found.start_data),
        near=near_findings(found),
        stopped=found.stopped,
        work=found.start_data.effort.done,
        notes=(
            *before.notes,
            *_softness(found),
            *([_NO_PAYLOAD] if verdict != "consistent" and found.model.payload_site is None else []),
        ),
    )


def _softness(found: Search) -> tuple[str, ...]:
    data = found.start_data
    fitted = data.replay.only(range(data.training))
    note = softness_note(found.model, fitted, _part(found.start_runs, slice(0, data.training)))
    return () if note is None else (note,)


def _held_out_floor(data: Data) -> float | None:
    return data.score(data.floor, held_out=True) if data.held_out else None


def _settled(found: Search) -> dict[str, float]:
    """What was found of the model's own properties on the way to the findings."""
    given, end = found.model, found.final.hypothesis.model
    pairs = {
        "sliding_speed": (given.sliding_speed, end.sliding_speed),
        "flank_retardation_s": (given.flank_retardation_s, end.flank_retardation_s),
        "full_braking": (given.actuators.full_braking, end.actuators.full_braking),
    }
    return {name: float(new) for name, (old, new) in pairs.items() if new != old}


def _clues_of_rest(verdict: Verdict, found: Search) -> Clues | None:
    """What shows the part that stays unexplained; None where noise explains it."""
    named = verdict in NAMED
    if found.consistent_before or (named and found.consistent_after):
        return None
    return Clues(found.start_data, found.final if named else found.start)


def _comparisons(model: Model, runs: Simulated, found: Search) -> list[Comparison]:
    """Of the recordings that were fitted, and of held-out ones where there are some."""
    data = found.start_data
    fitted, judging = slice(0, data.training), slice(data.training, None)
    return [evaluate(model, _part(runs, rows)) for rows in ([fitted, judging] if data.held_out else [fitted])]


def _part(runs: Simulated, of: slice) -> Simulated:
    noisy = tuple(draw[of] for draw in runs.noisy)
    return Simulated(runs.recordings[of], runs.clean[of], noisy, runs.noise, runs.shifted[of])
