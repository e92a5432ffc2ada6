"""What the loop asks a controller in every tick: the targets of the joints."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from .base import BaseMotion


class Target(NamedTuple):
    """Targets of a controller for the joints.

    Attributes:
        reference: (n,) [rad].
        feedforward: on top of the feedback, axis coordinates (n,) [N m].
        made: when it was decided [s].
    """

    reference: np.ndarray
    feedforward: np.ndarray
    made: float


class Controller(Protocol):
    """Interface of a controller."""

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: BaseMotion
    ) -> Target | None:
        """Return the targets; called once per tick.

        Args:
            now: nominal time of the tick [s].
            phase: of safety.
            position, velocity: of the joints (n,) [rad, rad/s].
            base: how it turns and where down is, as far as that is known.
        """
        ...
