"""Diagnose and add effects: the error falls step by step until the model explains the data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from workbench.core import Diagnosis, Improvement, Step, Verdict
from workbench.effects import load_model
from workbench.models import Model
from workbench.recordings import Source, load_recordings
from workbench.s3n import off_drives

from .diagnose import diagnosis_of
from .findings import step_of
from .problem import Progress
from .rounds import Rounds, comparisons, rounds
from .verdict import NAMED, refuted


def improve(
    model: Model | str | Path,
    training: Source | Iterable[Source],
    held_out: Source | Iterable[Source] = (),
    *,
    seed: int = 0,
    limit: int | None = None,
    nearest: bool = False,
    progress: Progress = lambda text: None,
) -> tuple[Improvement, Model]:
    """Return the steps of an improvement, and the model with all effects that explain the data.

    Args:
        model: what we believe, or its file or name.
        training: recordings to fit, one or several, or their files.
        held_out: recordings that only test the fit.
        seed: of the noise simulations.
        progress: told what is being done.
        limit: most effects to add one by one; None: as many as a diagnosis.
        nearest: where no cause can be named, add what lowers the error on data that were not fitted all the
            same. The verdict stays ``unexplained``.

    Returns:
        The steps with their errors, and the improved model; the model as given where nothing is added. Where
        gains in recordings are wrong, that is a step, and the model is without it: correct the recordings as
        `Diagnosis.mend` says, or by `with_mended_gains`. Errors are those with these gains corrected.

    Raises:
        InputError, SimulationError: as `diagnose`.
    """
    model, training = load_model(model), load_recordings(training, some=True)
    found = rounds(model, training, load_recordings(held_out), seed, progress, limit)
    first, last = found[0], found[-1]
    diagnosis = diagnosis_of(found)
    named = diagnosis.verdict in NAMED
    added = bool(first.steps) and (named or (nearest and not refuted(first)))
    after, held = diagnosis.after, diagnosis.held_out
    if added and not named and first.steps[-1].runs is not None:
        after, *holdout = comparisons(first.final.hypothesis.model, first.steps[-1].runs, first)
        held = (held[0], holdout[0]) if held else None
    before, end = first.start, last.final if added else first.start
    has_holdout = first.start_data.held_out
    done = last.consistent_after if named else diagnosis.verdict == "consistent"
    verdict: Verdict = "consistent" if done else "unexplained"
    verdict = "partly_explained" if diagnosis.verdict == "partly_explained" else verdict
    improvement = Improvement(
        model=model.name,
        steps=_steps(found, diagnosis) if added else (),
        error_before=first.start_data.score(before.mean_squares),
        error_after=last.start_data.score(end.mean_squares),
        holdout_error_before=first.start_data.score(before.mean_squares, held_out=True)
        if has_holdout
        else None,
        holdout_error_after=last.start_data.score(end.mean_squares, held_out=True) if has_holdout else None,
        noise_error=after.noise_error if after else diagnosis.noise_error,
        verdict=verdict,
        before=diagnosis.before,
        after=after,
        held_out=held,
        diagnosis=diagnosis,
        holdout_noise_error=diagnosis.holdout_noise_error,
        notes=diagnosis.notes,
        nearest=added and not named,
    )
    if not improvement.added:
        return improvement, model
    better = off_drives(end.hypothesis.model, model)
    effects = tuple(e for e in better.effects if e.key not in diagnosis.mend_recordings)
    ending = "improved" if named else "nearest"
    return improvement, replace(better, effects=effects, name=f"{model.name}_{ending}")


def _steps(found: Rounds, diagnosis: Diagnosis) -> tuple[Step, ...]:
    evidence, floor = {f.key: f.evidence for f in diagnosis.findings}, diagnosis.holdout_noise_error
    return tuple(step_of(k, f, floor, evidence) for f in found for k in range(len(f.steps)))
