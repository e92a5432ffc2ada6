"""The choice among several assumptions on how a loop works: the one that needs fewest effects."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.comparison import followed, matched_ways
from workbench.core import InputError, Recording
from workbench.models import Model
from workbench.simulation import scored_torque

from .acceptance import at_noise_floor
from .checks.loops import refuse_coordinates
from .checks.sign_check import refuse_wrong_sign_in_loop, refuse_wrong_sign_of_torque
from .checks.units import refuse_unit
from .data import Data
from .fitting.uncertainty import moved_apart
from .hypothesis import Fit
from .loss import rescored
from .made_by_mujoco import MadeByMujoco, MujocoSuspicion
from .node import is_consistent
from .policy import POLICY
from .problem import Progress
from .search import Asked, UnstableLoop, ask, search
from .search_result import SearchResult

_UNSTABLE = "The model is unstable in the loop"
_RIDGE = 1e-12  # beside scores, which may be none


@dataclass(frozen=True)
class Way:
    """Recordings to fit and to test under one assumption on how their loops work.

    Attributes:
        training, held_out: the recordings.
        asked: the model with them.
        unstable: why it is asked along the measured motion; None where the model runs in the loops.
    """

    training: tuple[Recording, ...]
    held_out: tuple[Recording, ...]
    asked: Asked
    unstable: UnstableLoop | None = None

    @staticmethod
    def of(
        model: Model,
        training: tuple[Recording, ...],
        held_out: tuple[Recording, ...],
        seed: int,
        limit: int | None,
        progress: Progress,
    ) -> Way:
        """Return the assumption with its recordings; along the measured motion if the model is unstable in
        the loop.

        Missing friction and rotor inertia may be what keeps the machine's loop stable.

        Raises:
            UnstableLoop: there, and no torque was recorded.
        """
        try:
            return Way(training, held_out, ask(model, training, held_out, seed, limit, progress))
        except UnstableLoop as error:
            if any(scored_torque(r) is None for r in (*training, *held_out)):
                raise
            along, tests = followed(training, _UNSTABLE), followed(held_out, _UNSTABLE)
            return Way(training, held_out, ask(model, along, tests, seed, limit, progress), error)

    def suspecting(self, suspect: Callable[[Fit, Data], None]) -> Way:
        """Return the same way, with what is asked of each better explanation in its search."""
        problem = replace(self.asked.problem, suspect=suspect)
        return replace(self, asked=replace(self.asked, problem=problem))

    def searched(self, *, only_jointly: bool = False, most: int | None = None) -> SearchResult:
        """Return the result of a search.

        Args:
            only_jointly: as of `search`.
            most: effects that are added one by one at the most, if fewer than were asked for.

        Raises:
            UnstableLoop: the model is unstable in the loops, and the torque does not show why.
        """
        asked, problem = self.asked, self.asked.problem
        if most is not None and most < problem.limit:
            asked = replace(asked, problem=replace(problem, limit=most, visited=set()))
        found = search(asked, only_jointly=only_jointly)
        shown = found.consistent_before or max(found.explained, found.median_explained) >= POLICY.near_named
        if self.unstable and not shown:
            raise self.unstable
        return found


def best_way(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording],
    seed: int,
    limit: int | None,
    progress: Progress,
) -> tuple[SearchResult, Way]:
    """Return the result, and the assumption on the loops, that needs fewest effects.

    Args:
        model, training, held_out, seed, limit, progress: as of `search.ask`.

    Raises:
        InputError: recordings that do not fit the model, or that show neither loop nor torque.
        SimulationError: the model is unstable in a recording's loop.
    """
    asked = partial(Way.of, model, seed=seed, limit=limit, progress=progress)
    suspicion = MujocoSuspicion((*training, *held_out), len(training), asked)
    ways = [asked(*way).suspecting(suspicion) for way in _matched(model, training, held_out)]
    if explained := suspicion.at_once(ways[0]):
        ways = [explained]
    _refuse_wrong_sign(ways[0].asked)
    try:
        ways, by_one_effect = _explaining(ways, progress)
        tried = by_one_effect or _searched(ways, progress)
    except MadeByMujoco as made:
        progress("searching again, as MuJoCo seems to have made the recordings")
        return made.way.searched(), made.way
    ties = _ties(tried)
    # a loop that reads noise otherwise leaves another level of it
    which = min(
        ties,
        key=lambda k: (tried[k].final.hypothesis.size, abs(np.log(_error(tried[k]) / _noise(tried[k])))),
    )
    others = [tried[k].final for k in ties if k != which]
    found = _covering(tried[which], others)
    return suspicion.searched(found) or (found, ways[which])


def _searched(ways: Sequence[Way], progress: Progress) -> list[SearchResult]:
    """Return the results of all assumptions; one that takes more effects than another is not the answer."""
    tried: list[SearchResult] = []
    for k, way in enumerate(ways):
        if k:
            progress(f"searching again with another assumption about the loop, {k + 1} of {len(ways)}")
        enough = [len(found.steps) for found in tried if found.consistent_after]
        tried.append(way.searched(most=max(1, min(enough)) if enough else None))
    return tried


def _refuse_wrong_sign(asked: Asked) -> None:
    start, data = asked.problem.start, asked.problem.data
    if data.replay.machine_alone and not is_consistent(data, start.mean_squares):
        error, floor = data.score(start.mean_squares), data.score(data.floor)
        refuse_wrong_sign_in_loop(start.hypothesis.model, asked.training, error, floor)


def _explaining(ways: Sequence[Way], progress: Progress) -> tuple[Sequence[Way], list[SearchResult]]:
    """Return the assumptions that may be right, those whose joint solution leaves only noise first.

    Where one effect alone leaves only noise under one of them, all come with the results of that.

    What a loop reads may hold noise that its log does not show, so that the right way too leaves more than
    what is known of it. A loop that is not the machine's asks for more: for a rotor on every axis, say, or
    for damping and rotors where drives are late. So a joint solution of several numbers is the answer only if
    no other assumption needs fewer effects; of many axes only a delay is asked, which looks like these.
    """
    if len(ways) == 1:
        return ways, []
    progress(f"testing {len(ways)} assumptions about how the loop works")
    found = [search(way.asked, only_jointly=True) for way in ways]
    ties = _ties(found)
    kept = [k for k in ties if _is_at_noise(found[k])]
    if not kept and all(found[k].explained >= POLICY.explained for k in ties):
        kept = ties
    fewest = min((found[k].final.hypothesis.size for k in kept), default=POLICY.most_effects)
    kept = [k for k in kept if found[k].final.hypothesis.size == fewest]
    expensive = any(way.asked.problem.is_expensive for way in ways)
    if fewest <= 1 or (expensive and not kept):
        return [ways[k] for k in kept] or ways, []
    # a delay, which is no torque along the motion, may suffice alone
    likely = any(way.asked.problem.one_effect_may_suffice for way in ways)
    alone = [way.searched(most=1) for way in ways] if likely else []
    if any(one.consistent_after for one in alone):
        return ways, alone
    others = [k for k in range(len(ways)) if k not in kept and fewest > 2 and not expensive]
    return [ways[k] for k in (*kept, *others)], []


def _is_at_noise(found: SearchResult) -> bool:
    final, data = found.final, found.final_data
    return found.consistent_after or at_noise_floor(rescored(final, data), data)


def _ties(found: Sequence[SearchResult]) -> list[int]:
    """Return which results leave as little as the best; below the noise all count as equal."""
    noise = min(map(_noise, found))
    most = (1.0 + POLICY.tie) * max(noise, min(map(_error, found)))
    return [k for k, each in enumerate(found) if _error(each) <= most]


def _covering(found: SearchResult, others: Sequence[Fit]) -> SearchResult:
    """Return the result with intervals that also cover the values under the other assumptions on the loop."""
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
    """Return the final score, on recordings that were not fitted if there are some."""
    return _RIDGE + found.start_data.score(found.final.mean_squares, held_out=found.start_data.held_out)


def _noise(found: SearchResult) -> float:
    """Return the same score of noise alone."""
    return _RIDGE + found.final_data.score(found.final_data.floor, held_out=found.start_data.held_out)


def _matched(
    model: Model, training: Sequence[Recording], held_out: Sequence[Recording]
) -> list[tuple[tuple[Recording, ...], tuple[Recording, ...]]]:
    """Return recordings to fit and to test, for each plausible answer to what their logs leave open."""
    ways = matched_ways(model, (*training, *held_out))
    count = len(training)
    fitted, tests = ways[0][:count], ways[0][count:]
    rows = sum(int(r.valid.sum()) for r in fitted)
    if rows < POLICY.fewest_rows:
        raise InputError(
            f"{rows} rows are too few to distinguish one effect from another", file=fitted[0].source,
            remedy=f"record for longer, {POLICY.fewest_rows} rows at least and seconds of motion",
        )  # fmt: skip
    if all(np.ptp(r.position[r.valid], axis=0).max() == 0.0 for r in fitted):
        raise InputError(
            "no axis moves in these recordings", file=fitted[0].source,
            remedy="record motion: an axis at rest shows no effect",
        )  # fmt: skip
    refuse_coordinates(model, (*fitted, *tests))
    refuse_unit(model, fitted)
    refuse_wrong_sign_of_torque(model, fitted)
    return [(way[:count], way[count:]) for way in ways]
