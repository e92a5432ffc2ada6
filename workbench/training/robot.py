"""What an evaluation's hardware has beyond its drawing: nothing, unless a study of other robots says so."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .machine import Machine
from .own_plant import OwnPlant
from .plant import Plant
from .plants import ClosedChainPlant


class Robot:
    """The hardware as it is drawn.

    Attributes:
        latency_steps: control steps by which actions come later than the model says.
        imu_steps: control steps by which the inertial unit is late.
    """

    latency_steps: int = 0
    imu_steps: int = 0

    def plant(self, machine: Machine) -> Plant:
        """Return the hardware of a machine.

        Raises:
            InputError: none can be made of it.
        """
        return ClosedChainPlant(machine) if machine.floating else OwnPlant(machine)

    def delivered(self, torque: np.ndarray, speed: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Return the torque (n,) [N m] that drives give for a command, at speeds (n,) [rad/s].

        `limit` (n,) is the largest torque [N m].
        """
        return torque

    def felt(
        self, gravity: np.ndarray, angular: np.ndarray, before: Sequence[tuple[np.ndarray, np.ndarray]]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the reading of the inertial unit without noise: gravity direction and angular velocity, (1,
        3) each.

        `before`: true values of earlier control steps, the last one first.
        """
        return gravity, angular


IDEAL = Robot()
