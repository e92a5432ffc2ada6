"""The work budget of a search: simulated steps and linear solves, and their limit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core import Recording

from .policy import POLICY

_TICK_S = 1e-3  # simulation takes no longer steps, however seldom was recorded


@dataclass
class WorkBudget:
    """Work of one search, counted in steps instead of time, so that it ends at the same place on any machine.

    Attributes:
        most: steps after which nothing new is begun.
        done: steps so far.
    """

    most: float = float("inf")
    done: float = 0.0

    @staticmethod
    def for_search(recordings: Sequence[Recording], simulates: bool = True) -> WorkBudget:
        """Return the budget of a search on these recordings; unlimited if nothing is simulated."""
        least = POLICY.budget_runs * _steps(recordings)
        return WorkBudget(max(POLICY.budget_steps, least) if simulates else float("inf"))

    @property
    def spent(self) -> bool:
        """Return whether the budget is used up."""
        return self.done > self.most

    def add(self, recordings: Sequence[Recording], runs: int = 0, columns: int = 0) -> None:
        """Count runs of these recordings, and columns propagated along them."""
        self.done += (runs + POLICY.column_cost * columns) * _steps(recordings)


def _steps(recordings: Sequence[Recording]) -> float:
    return sum(len(r) * len(r.axes) * max(1.0, r.period / _TICK_S) for r in recordings)
