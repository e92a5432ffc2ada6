"""What drives carry that is no tree: known by the torque that it needs along a motion."""

from __future__ import annotations

from typing import Protocol

import numpy as np


class Carried(Protocol):
    """Links behind a transmission that changes with the posture, in the coordinates of N drives."""

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """That the drives need for their motion (N, n), without what rotors need [N m or N].

        Raises:
            SimulationError: drives far from where the links can go.
        """
        ...

    def inertia(self, position: np.ndarray) -> np.ndarray:
        """Of the links as the drives feel it (N, n, n) [kg m^2 or kg]."""
        ...
