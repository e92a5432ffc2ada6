"""The search on recordings that MuJoCo made, which have the steps and the friction of the model's file.

That is no fact about a machine, so no effect. What a search has found is fitted again to the recordings as
MuJoCo would have made them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from workbench.comparison import made_by_mujoco
from workbench.core import Recording

from .data import Data
from .fitting.fit import fit
from .hypothesis import Fit
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


def refuse_made_by_mujoco(
    best: Fit, data: Data, *, given: Sequence[Recording], asked: Callable[..., Way]
) -> None:
    """Stop a search whose best explanation shows that MuJoCo made the recordings.

    Args:
        best: the explanation.
        data: the recordings as those of a machine.
        given: the recordings without assumptions about their loop, those to fit first.
        asked: the search on other recordings, those to fit and those to test.

    Raises:
        MadeByMujoco: it left half as much there.
    """
    left, way = min(_again(best, data, given, asked), key=itemgetter(0), default=(0.0, None))
    if way is not None and left <= POLICY.exchange_left * _excess(data, best):
        raise MadeByMujoco(way)


def searched_by_mujoco(
    found: SearchResult, given: Sequence[Recording], asked: Callable[..., Way]
) -> tuple[SearchResult, Way] | None:
    """Return the result and the recordings if MuJoCo made these from the model's file; otherwise None.

    Where the error of the model or of what was found is lower there, all is searched again, and where that
    search leaves half of what the first one left above the noise, it is the result.

    Args:
        found: the result on recordings of a machine.
        given, asked: as of `refuse_made_by_mujoco`.
    """
    data, left = found.final_data, _excess(found.final_data, found.final)
    if found.consistent_before:
        return None
    tried: list[tuple[float, Way]] = []
    for after, way in _again(found.final, data, given, asked):
        start = way.asked.problem
        if after < left or _excess(start.data, start.start, data) < _excess(data, found.start):
            tried.append((after, way))
    if not tried:
        return None
    _, way = min(tried, key=itemgetter(0))
    way.asked.problem.progress("searching again, as MuJoCo seems to have made the recordings")
    result = way.searched()
    lower = _excess(result.final_data, result.final, data) <= POLICY.exchange_left * left
    return (result, way) if lower else None


def _again(
    last: Fit, data: Data, given: Sequence[Recording], asked: Callable[..., Way]
) -> list[tuple[float, Way]]:
    """What a fit leaves above the noise of recordings as MuJoCo made them, by each way of that which may
    halve it.
    """
    left, out = _excess(data, last), []
    least = (1.0 - POLICY.exchange_left**0.5) ** 2 * left  # a smaller change cannot halve it
    for made in made_by_mujoco(last.hypothesis.model, data.recordings, given):
        if data.objective(made.change) >= least > 0.0:
            way = asked(made.recordings[: data.training], made.recordings[data.training :])
            there = way.asked.problem.data
            (again,) = fit([last.hypothesis], there)
            out.append((left if again is None else _excess(there, again, data), way))
    return out


def _excess(data: Data, final: Fit, like: Data | None = None) -> float:
    """Return the loss of the fitted error above the noise of each signal, with the weights of other data."""
    weighed = data if like is None else replace(data, weight=like.weight)
    return weighed.objective(np.maximum(data.pool(final.mean_squares) - data.least(), 0.0))
