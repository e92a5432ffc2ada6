"""What the loop asks every tick: where the joints are to go."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from .base import BaseMotion


class Target(NamedTuple):
    """What a controller wants of the joints.

    Attributes:
        reference: (n,) [rad].
        feedforward: on top of the feedback, axis coordinates (n,) [N m].
        made: when it was decided [s].
    """

    reference: np.ndarray
    feedforward: np.ndarray
    made: float


class Controller(Protocol):
    """Decides where the joints go."""

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: BaseMotion
    ) -> Target | None:
        """Once a tick.

        Args:
            now: nominal time of the tick [s].
            phase: of safety.
            position, velocity: of the joints (n,) [rad, rad/s].
            base: how it turns and where down is, as far as that is known.
        """
        ...
