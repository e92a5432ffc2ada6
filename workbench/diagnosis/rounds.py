"""Repeated searches, each on the model that the previous search improved, until nothing more is named."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.comparison import Simulated, evaluate
from workbench.core import Comparison, Recording, SimulationError
from workbench.models import Model
from workbench.s3n import on_drives

from .policy import POLICY
from .problem import Progress
from .search_result import SearchResult
from .verdict import NAMED, verdict_of
from .ways import Way, best_way

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
    """Return the results of all searches, the first one on the model as given.

    Which effects of a joint solution are certain depends on what else is in the model: so the search is
    repeated in the improved model until nothing is added.

    Raises:
        InputError: recordings that do not fit the model, or that show neither loop nor torque.
        SimulationError: the model is unstable in a recording's loop.
    """
    found, way = best_way(on_drives(model), training, held_out, seed, limit, progress)
    out, rounds_at_most = [found], limit or POLICY.most_effects
    while found.jointly and not _ends(found) and len(out) < rounds_at_most and _names(found):
        progress("searching again, with what was found in the model")
        better = found.final.hypothesis.model
        try:
            again = Way.of(better, way.training, way.held_out, seed, limit, progress)
            found = again.searched(only_jointly=True)
        except SimulationError:
            break
        if not (found.steps and _names(found)):
            break
        out.append(found)
    return tuple(out)


def _ends(found: SearchResult) -> bool:
    """Return whether nothing is left to name: noise explains the rest, or several numbers of links do."""
    return found.consistent_after or found.of_links


def _names(found: SearchResult) -> bool:
    return verdict_of(found) in NAMED


def comparisons(model: Model, runs: Simulated, found: SearchResult) -> list[Comparison]:
    """Return comparisons of the training recordings and, if there are any, of the held-out ones."""
    data = found.start_data
    training_recordings, test_recordings = slice(0, data.training), slice(data.training, None)
    return [
        evaluate(model, part_of(runs, rows))
        for rows in ([training_recordings, test_recordings] if data.held_out else [training_recordings])
    ]


def part_of(runs: Simulated, of: slice) -> Simulated:
    """Return the runs of some of the recordings."""
    noisy = tuple(draw[of] for draw in runs.noisy)
    return Simulated(
        runs.recordings[of], runs.clean[of], noisy, runs.noise, runs.shifted[of], runs.creeping[of]
    )
