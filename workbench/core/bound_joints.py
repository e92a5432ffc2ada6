"""Joints that follow others, as equations in the coordinates of a tree."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .coupling import Coupling


@dataclass(frozen=True)
class BoundJoints:
    """Couplings as equations in the coordinates of a tree, zero when they are met.

    Attributes:
        pairs: each coupling, the coordinate that follows, and the one followed (None: it is held).
    """

    pairs: tuple[tuple[Coupling, int, int | None], ...]

    @staticmethod
    def of(couplings: Sequence[Coupling], place: Callable[[str], int]) -> BoundJoints:
        """Return the couplings of a tree; `place` gives the coordinate of a joint."""
        return BoundJoints(
            tuple((c, place(c.joint), place(c.follows) if c.follows else None) for c in couplings)
        )

    def gap(self, theta: np.ndarray) -> np.ndarray:
        """Return the distance of each joint from its required position (k,) [rad or m]."""
        return np.array([theta[a] - c.at(0.0 if b is None else theta[b])[0] for c, a, b in self.pairs])

    def jacobian(self, theta: np.ndarray) -> np.ndarray:
        """Return d gap / d theta (k, N)."""
        rows = np.zeros((len(self.pairs), len(theta)))
        for row, (c, a, b) in zip(rows, self.pairs, strict=True):
            row[a] = 1.0
            if b is not None:
                row[b] -= c.at(theta[b])[1]
        return rows

    def bias(self, theta: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return the second derivative of the gap at zero acceleration (k,)."""
        bends = (0.0 if b is None else -c.at(theta[b])[2] * rates[b] ** 2 for c, _, b in self.pairs)
        return np.fromiter(bends, float, len(self.pairs))
