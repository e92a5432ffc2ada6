"""Drives with hidden effects, row by row, for a robot whose links are simulated elsewhere.

Each drive gets a measured torque and gives the torque that reaches its link. A drive without play moves as
one with its link, so that its rotor and damping belong to whoever moves the links; one with play has a rotor
of its own here. Steps have to be short: half a millisecond at flanks of 400 N m/rad.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError

from .drive_side import DriveSide

_CREEP = 0.01  # rad/s below which dry friction falls to zero: an explicit step cannot hold a thing still


class DriveTrain:
    """The drives of a robot (n of them).

    Args:
        sides: one per drive.
        step: by which they move on [s].

    Attributes:
        rotor: inertia that moves as one with each link (n,) [kg m^2].
        damping: of that motion (n,) [N m s/rad].

    Raises:
        InputError: flanks too stiff for the step.
    """

    def __init__(self, sides: Sequence[DriveSide], step: float) -> None:
        for side in sides:
            if not side.rigid and side.stiffness * step**2 > 0.1 * side.inertia:
                raise InputError(
                    f"flanks of {side.stiffness:g} N m/rad are too stiff for steps of {step:g} s"
                )
        self._step = step
        self._gain, self._friction, self._inertia, own, self._gap, self._stiffness = np.array(
            [(s.gain, s.friction, s.inertia, s.damping, s.gap, s.stiffness) for s in sides]
        ).T
        self._plays = np.array([not s.rigid for s in sides])
        self._damping = own
        self.rotor = np.where(self._plays, 0.0, self._inertia)
        self.damping = np.where(self._plays, 0.0, own)
        self._angle, self._speed = np.zeros(len(sides)), np.zeros(len(sides))

    def reset(self, position: np.ndarray) -> None:
        """Set it at rest with every rotor in the middle of its play (n,) [rad]."""
        self._angle, self._speed = np.array(position, float), np.zeros(len(position))

    def motion(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return angles and speeds of the rotors, which encoders see, from those of the links, (n,) each."""
        return np.where(self._plays, self._angle, position), np.where(self._plays, self._speed, velocity)

    def advance(self, torque: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Simulate one step.

        Args:
            torque: measured, of each drive (n,) [N m].
            position, velocity: of each link where the step begins (n,) [rad, rad/s].

        Returns:
            Torque on each link during the step (n,) [N m].
        """
        speed = np.where(self._plays, self._speed, velocity)
        rubbed = self._gain * torque - self._friction * np.clip(speed / _CREEP, -1.0, 1.0)
        wind = self._angle - position
        half = 0.5 * self._gap
        passed = self._stiffness * (wind - np.clip(wind, -half, half))
        self._speed = np.where(
            self._plays,
            self._speed + self._step * (rubbed - self._damping * self._speed - passed) / self._inertia,
            velocity,
        )
        self._angle = np.where(self._plays, self._angle + self._step * self._speed, position)
        return np.where(self._plays, passed, rubbed)
