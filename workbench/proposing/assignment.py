"""Which column is which signal of which joint, as far as known."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Signals:
    """Signal -> joint -> column, and remarks on how it came about.

    Attributes:
        columns: the assignment.
        because: signal -> reason.
        sure: signal -> how sure.
        notes: what does not fit.
    """

    columns: dict[str, dict[str, str]] = field(default_factory=dict)
    because: dict[str, str] = field(default_factory=dict)
    sure: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def put(self, signal: str, joint: str, column: str, because: str, sure: float) -> None:
        """Assign one column; the confidence of a signal is that of its least certain column."""
        self.columns.setdefault(signal, {})[joint] = column
        if sure < self.sure.get(signal, 2.0):
            self.sure[signal], self.because[signal] = sure, because

    def drop(self, signal: str) -> None:
        """Remove a signal."""
        self.columns.pop(signal, None)

    def used(self) -> set[str]:
        """Return every column that has a meaning."""
        return {c for by_joint in self.columns.values() for c in by_joint.values()}


def moves(values: np.ndarray) -> bool:
    """Return whether a column changes at all."""
    return bool(np.ptp(values[np.isfinite(values)]) > 0)


def filled(values: np.ndarray) -> np.ndarray:
    """Return the column with empty cells interpolated; zeros where all are empty."""
    good = np.isfinite(values)
    if good.all():
        return values
    at = np.arange(len(values))
    return np.interp(at, at[good], values[good]) if good.any() else np.zeros(len(values))
