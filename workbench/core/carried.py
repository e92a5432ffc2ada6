"""Linkage parts that drives carry outside the serial tree: the torque they need along a motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np


@dataclass(frozen=True)
class CarriedMotion:
    """N rows of n serial joints that follow the drives.

    Attributes:
        position, velocity, acceleration: of the joints (N, n).
        slope: J^-1, d q_s / d q_p (N, n, n).
        inertia: of the links as the joints feel it (N, n, n) [kg m^2 or kg].
        torque: of the joints that the links need (N, n) [N m or N].
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    slope: np.ndarray
    inertia: np.ndarray
    torque: np.ndarray


class Carried(Protocol):
    """Links behind a transmission that changes with the posture.

    Attributes:
        serial: MJCF of the tree of those links that the serial joints move.
        joints: these joints, in the order of the axes.
    """

    serial: Path
    joints: tuple[str, ...]

    def at(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> CarriedMotion:
        """Return motion and torque of the links along a motion of the drives (N, n), rotors left out.

        Raises:
            SimulationError: drives far from where the links can go.
        """
        ...

    def weights(self, position: np.ndarray) -> Mapping[str, tuple[float, np.ndarray]]:
        """Return parts that move and are not in that tree, cranks and rods: mass [kg], and the torque (n,)
        that the drives at `position` (n,) need for each kilogram more of it [N m or N].
        """
        ...
