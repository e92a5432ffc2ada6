"""The suspicion that MuJoCo made the recordings from the model's file, and the search if it did.

Its steps and its soft friction are no fact about a machine, so no effect. What a search has found is fitted
again to the recordings as MuJoCo would have made them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from workbench.comparison import explained_by_mujoco, made_by_mujoco
from workbench.core import Controller, Recording, Timing

from .data import Data
from .fitting.fit import fit
from .hypothesis import Fit
from .node import is_consistent
from .policy import POLICY
from .search_result import SearchResult

if TYPE_CHECKING:
    from .ways import Way


class MadeByMujoco(Exception):
    """Raised in a search if its best explanation leaves half as much on the recordings as MuJoCo made them.

    `way`: these recordings, to be searched instead.
    """

    def __init__(self, way: Way) -> None:
        super().__init__("MuJoCo made the recordings")
        self.way = way


@dataclass(frozen=True)
class MujocoSuspicion:
    """What is asked before a search, of each better explanation in it, and after it.

    Attributes:
        given: the recordings without assumptions about their loop, those to fit first.
        training: how many are to fit.
        asked: the search on other recordings, those to fit and those to test.
    """

    given: Sequence[Recording]
    training: int
    asked: Callable[..., Way]
    _ways: dict[tuple[tuple[Timing, Controller], ...], Way] = field(default_factory=dict)

    def at_once(self, way: Way) -> Way | None:
        """Return the recordings as MuJoCo made them, if the model explains these and not those of a way."""
        start, data = way.asked.problem.start, way.asked.problem.data
        if is_consistent(data, start.mean_squares):
            return None
        made = explained_by_mujoco(start.hypothesis.model, data.recordings, self.given)
        return None if made is None else self._way(made)

    def __call__(self, best: Fit, data: Data) -> None:
        """Stop a search whose best explanation shows that MuJoCo made the recordings.

        Raises:
            MadeByMujoco: it leaves half as much there.
        """
        left, way = min(self._again(best, data), key=itemgetter(0), default=(0.0, None))
        if way is not None and left <= POLICY.exchange_left * _excess(data, best):
            raise MadeByMujoco(way)

    def searched(self, found: SearchResult) -> tuple[SearchResult, Way] | None:
        """Return the result and the recordings if MuJoCo made these; otherwise None.

        Where the error of the model or of what was found is lower there, all is searched again, and where
        that search leaves half of what the first one left above the noise, it is the result.
        """
        data, left = found.final_data, _excess(found.final_data, found.final)
        if found.consistent_before:
            return None
        tried: list[tuple[float, Way]] = []
        for after, way in self._again(found.final, data):
            there = way.asked.problem
            if after < left or _excess(there.data, there.start, data) < _excess(data, found.start):
                tried.append((after, way))
        if not tried:
            return None
        _, way = min(tried, key=itemgetter(0))
        way.asked.problem.progress("searching again, as MuJoCo seems to have made the recordings")
        result = way.searched()
        lower = _excess(result.final_data, result.final, data) <= POLICY.exchange_left * left
        return (result, way) if lower else None

    def _again(self, last: Fit, data: Data) -> list[tuple[float, Way]]:
        """What a fit leaves above the noise of recordings as MuJoCo made them, by each way of that which may
        halve it.
        """
        left, out = _excess(data, last), []
        least = (1.0 - POLICY.exchange_left**0.5) ** 2 * left  # a smaller change cannot halve it
        for made in made_by_mujoco(last.hypothesis.model, data.recordings, self.given):
            if data.objective(made.change) >= least > 0.0:
                way = self._way(made.recordings)
                there = way.asked.problem.data
                (again,) = fit([last.hypothesis], there)
                out.append((left if again is None else _excess(there, again, data), way))
        return out

    def _way(self, recordings: Sequence[Recording]) -> Way:
        """The search on such recordings, whose noise is simulated once."""
        key = tuple((r.timing, r.controller) for r in recordings)
        if key not in self._ways:
            self._ways[key] = self.asked(
                tuple(recordings[: self.training]), tuple(recordings[self.training :])
            )
        return self._ways[key]


def _excess(data: Data, final: Fit, like: Data | None = None) -> float:
    """Return the loss of the fitted error above the noise of each signal, with the weights of other data."""
    weighed = data if like is None else replace(data, weight=like.weight)
    return weighed.objective(np.maximum(data.pool(final.mean_squares) - data.least(), 0.0))
