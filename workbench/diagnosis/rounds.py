"""Repeated searches, each in the model that the previous one improved, until nothing more is named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import Simulated, evaluate, followed, matched_ways
from workbench.core import Comparison, InputError, Recording, SimulationError
from workbench.models import Model
from workbench.simulation import scored_torque

from .checks.loops import refuse_coordinates
from .checks.sign_check import refuse_wrong_sign_of_torque
from .checks.units import refuse_unit
from .fitting.uncertainty import moved_apart
from .hypothesis import Fit
from .policy import POLICY
from .problem import Progress
from .search import UnstableLoop, search
from .search_result import SearchResult
from .verdict import NAMED, verdict_of

_UNSTABLE = "The model is unstable in the loop"

_RIDGE = 1e-12  # beside scores, which may be none
Rounds = tuple[SearchResult, ...]


def rounds(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording],
    seed: int,
    progress: Progress,
    limit: int | None = None,
) -> Rounds:
    """The results of all searches, the first one in the model as given.

    Which effects of a joint solution are certain depends on what else is in the model: so the search is
    repeated in the improved model until nothing is added.

    Raises:
        InputError: recordings that do not fit the model, or that show neither loop nor torque.
        SimulationError: the model is unstable in a recording's loop.
    """
    ways = _matched(model, training, held_out)
    tried = []
    for k, (training, held_out) in enumerate(ways):
        if k:
            progress(f"asking again with another way in which the loop may work, {k + 1} of {len(ways)}")
        tried.append((_searched(model, training, held_out, seed, limit, progress), training, held_out))
    noise = min(_noise(t[0]) for t in tried)  # below it no way explains more than another
    most = (1.0 + POLICY.tie) * max(noise, min(_error(t[0]) for t in tried))
    ties = [t for t in tried if _error(t[0]) <= most]
    # a loop that reads noise otherwise leaves another level of it
    found, training, held_out = min(
        ties, key=lambda t: (t[0].final.hypothesis.size, abs(np.log(_error(t[0]) / _noise(t[0]))))
    )
    found = _covering(found, [t[0].final for t in ties if t[0] is not found])
    out, rounds_at_most = [found], limit or POLICY.most_effects
    while found.jointly and not found.consistent_after and len(out) < rounds_at_most and _names(found):
        progress("asking again, with what was found in the model")
        better = found.final.hypothesis.model
        try:
            found = _searched(better, training, held_out, seed, limit, progress, only_jointly=True)
        except SimulationError:
            break
        if not (found.steps and _names(found)):
            break
        out.append(found)
    return tuple(out)


def _covering(found: SearchResult, others: Sequence[Fit]) -> SearchResult:
    """The result with intervals that cover the same effects by other ways in which the loop may work."""
    own, alike = found.final, []
    for other in others:
        there = {(a.key, tuple(a.parameters)): a for a in other.hypothesis.free}
        asked = [(a.key, tuple(a.parameters)) for a in own.hypothesis.free]
        if there.keys() == set(asked):
            free = tuple(there[key] for key in asked)
            alike.append(replace(other, hypothesis=replace(other.hypothesis, free=free)))
    if not (alike and found.steps):
        return found
    last = replace(found.steps[-1], fit=moved_apart(own, own, alike))
    return replace(found, steps=(*found.steps[:-1], last))


def _error(found: SearchResult) -> float:
    """The score in the end, on recordings that were not fitted where there are some."""
    return _RIDGE + found.start_data.score(found.final.mean_squares, held_out=found.start_data.held_out)


def _noise(found: SearchResult) -> float:
    """The same of noise alone."""
    return _RIDGE + found.final_data.score(found.final_data.floor, held_out=found.start_data.held_out)


def _names(found: SearchResult) -> bool:
    return verdict_of(found)[0] in NAMED


def _searched(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording],
    seed: int,
    limit: int | None,
    progress: Progress,
    *,
    only_jointly: bool = False,
) -> SearchResult:
    """The result of a search in the loops; along the measured motion where the model is unstable in them.

    Missing friction and rotor inertia may be what keeps the machine's loop stable. If the torque along the
    motion shows them, they are the answer; else the unstable loop is reported.
    """
    try:
        return search(model, training, held_out, seed, limit, progress, only_jointly=only_jointly)
    except UnstableLoop:
        every = (*training, *held_out)
        if any(scored_torque(r) is None for r in every):
            raise
        along, test_recordings = followed(training, _UNSTABLE), followed(held_out, _UNSTABLE)
        found = search(model, along, test_recordings, seed, limit, progress, only_jointly=only_jointly)
        if not found.consistent_before and max(found.explained, found.median_explained) < POLICY.near_named:
            raise
        return found


def _matched(
    model: Model, training: Sequence[Recording], held_out: Sequence[Recording]
) -> list[tuple[tuple[Recording, ...], tuple[Recording, ...]]]:
    """Recordings to fit and to test, by all answers that may be right to what their logs leave open."""
    ways = matched_ways(model, (*training, *held_out))
    count = len(training)
    training_recordings, test_recordings = ways[0][:count], ways[0][count:]
    rows = sum(int(r.valid.sum()) for r in training_recordings)
    if rows < POLICY.fewest_rows:
        raise InputError(
            f"{rows} rows are too few to tell one effect from another", file=training_recordings[0].source,
            remedy=f"record for longer, {POLICY.fewest_rows} rows at least and seconds of motion",
        )  # fmt: skip
    if all(np.ptp(r.position[r.valid], axis=0).max() == 0.0 for r in training_recordings):
        raise InputError(
            "no axis moves in these recordings", file=training_recordings[0].source,
            remedy="record some motion: what stands still shows no effect",
        )  # fmt: skip
    refuse_coordinates(model, (*training_recordings, *test_recordings))
    refuse_unit(model, training_recordings)
    refuse_wrong_sign_of_torque(model, training_recordings)
    return [(way[:count], way[count:]) for way in ways]


def comparisons(model: Model, runs: Simulated, found: SearchResult) -> list[Comparison]:
    """Comparisons of the training recordings, and of the held-out ones where there are some."""
    data = found.start_data
    training_recordings, test_recordings = slice(0, data.training), slice(data.training, None)
    return [
        evaluate(model, part_of(runs, rows))
        for rows in ([training_recordings, test_recordings] if data.held_out else [training_recordings])
    ]


def part_of(runs: Simulated, of: slice) -> Simulated:
    """The runs of some of the recordings."""
    noisy = tuple(draw[of] for draw in runs.noisy)
    return Simulated(
        runs.recordings[of], runs.clean[of], noisy, runs.noise, runs.shifted[of], runs.creeping[of]
    )
