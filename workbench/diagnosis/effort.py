"""How much a search has simulated, and when that is enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core import Recording

# Steps of one coordinate after which nothing new is begun: ten times what one missing effect of a minute at
# 1 kHz of two axes takes, some minutes on two cores. Long recordings are worth as many runs of each.
_STEPS, _RUNS = 4e8, 800
_TICK = 1e-3  # s; simulation takes no longer steps, however seldom was recorded


@dataclass
class Effort:
    """Work of one search, counted and not timed, so that the same search ends at the same place anywhere.

    Attributes:
        most: steps after which nothing new is begun.
        done: steps so far.
    """

    most: float = float("inf")
    done: float = 0.0

    @staticmethod
    def for_search(recordings: Sequence[Recording]) -> Effort:
        """What a search on these recordings may take."""
        return Effort(max(_STEPS, _RUNS * _steps(recordings)))

    @property
    def spent(self) -> bool:
        """Whether nothing new is to be begun."""
        return self.done > self.most

    def add(self, recordings: Sequence[Recording], times: int) -> None:
        """Counts so many runs of these recordings, or columns that travel along them."""
        self.done += times * _steps(recordings)


def _steps(recordings: Sequence[Recording]) -> float:
    return sum(len(r) * len(r.axes) * max(1.0, r.period / _TICK) for r in recordings)
