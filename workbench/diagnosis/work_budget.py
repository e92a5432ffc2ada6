"""The work budget of a search: simulated steps and linear solves, and their limit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core import Recording

from .policy import POLICY

_TICK_S = 1e-3  # simulation takes no longer steps, however seldom was recorded


@dataclass
class WorkBudget:
    """Work of one search, counted and not timed, so that the same search ends at the same place anywhere.

    Attributes:
        most: steps after which nothing new is begun.
        done: steps so far.
    """

    most: float = float("inf")
    done: float = 0.0

    @staticmethod
    def for_search(recordings: Sequence[Recording], simulates: bool = True) -> WorkBudget:
        """What a search on these recordings may take; no end where nothing is simulated."""
        return WorkBudget(_most(recordings) if simulates else float("inf"))

    @property
    def spent(self) -> bool:
        """Whether nothing new is to be begun."""
        return self.done > self.most

    def add(self, recordings: Sequence[Recording], runs: int = 0, columns: int = 0) -> None:
        """Counts so many runs of these recordings, and columns that travel along them."""
        self.done += (runs + POLICY.column_cost * columns) * _steps(recordings)


def _most(recordings: Sequence[Recording]) -> float:
    return max(POLICY.budget_steps, POLICY.budget_runs * _steps(recordings))


def _steps(recordings: Sequence[Recording]) -> float:
    return sum(len(r) * len(r.axes) * max(1.0, r.period / _TICK_S) for r in recordings)
