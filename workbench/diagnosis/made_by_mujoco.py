"""The search on recordings that MuJoCo made, which have the steps and the friction of the model's file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import TYPE_CHECKING

from workbench.comparison import made_by_mujoco
from workbench.core import Recording

from .data import Data
from .fitting.fit import fit
from .hypothesis import Fit
from .policy import POLICY
from .search_result import SearchResult

if TYPE_CHECKING:
    from .ways import Way


def searched_by_mujoco(
    found: SearchResult, taken: Sequence[Recording], given: Sequence[Recording], asked: Callable[..., Way]
) -> tuple[SearchResult, Way] | None:
    """Return the result and the recordings if MuJoCo made these from the model's file; otherwise None.

    That is no fact about a machine, so no effect. The model and what was found are fitted to the recordings
    as MuJoCo would have made them. Where that lowers the error of either, all is searched again as it lowers
    it most, and where that search leaves half of what the first one left above the noise, it is the result.

    Args:
        found: the result on recordings of a machine.
        taken: these recordings, those to fit first.
        given: the same without assumptions about their loop.
        asked: the search on other recordings, those to fit and those to test.
    """
    data, start, last = found.final_data, found.start, found.final
    left, half = _excess(data, last), POLICY.exchange_left
    if found.consistent_before or left <= 0.0:
        return None
    tried: list[tuple[float, Way]] = []
    for made in made_by_mujoco(last.hypothesis.model, taken, given):
        if made.change < (1.0 - half**0.5) ** 2 * left:
            continue  # which is too little to halve it
        way = asked(made.recordings[: data.training], made.recordings[data.training :])
        there, before = way.asked.problem.data, way.asked.problem.start
        (again,) = fit([last.hypothesis], there)
        after = left if again is None else _excess(there, again)
        if after < left or _excess(there, before) < _excess(data, start):
            tried.append((after, way))
    if not tried:
        return None
    _, way = min(tried, key=itemgetter(0))
    way.asked.problem.progress("searching again, as MuJoCo seems to have made the recordings")
    result = way.searched()
    return (result, way) if _excess(result.final_data, result.final) <= half * left else None


def _excess(data: Data, final: Fit) -> float:
    """Return the mean square of the fitted error above the noise, over that of the signals."""
    return data.score(final.mean_squares) ** 2 - data.score(data.floor) ** 2
