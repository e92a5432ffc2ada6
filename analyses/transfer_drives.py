"""Drives of the study's robots with hidden effects: on a bench, and row by row behind every joint of a robot.

In a robot each drive gets a measured torque and gives the torque that reaches its link. A drive without play
moves as one with its link, so that its rotor and damping belong to whoever moves the links; one with play has
a rotor of its own here. Steps have to be short: half a millisecond at flanks of 400 N m/rad.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log

import numpy as np

from workbench.core import InputError
from workbench.rigs import HiddenEffect, Sensors, VirtualBench
from workbench.rigs.bench import ROW, shaft_constants
from workbench.rigs.machine import ACTUATOR_DAMPING, ACTUATOR_INERTIA

_CREEP = 0.01  # rad/s below which dry friction falls to zero: an explicit step cannot hold a thing still
#: Effects that a drive has by itself, and those that it has only with something hanging on it.
_OWN = ("torque_constant_error", "coulomb_friction", "viscous_damping", "reflected_inertia")
_COUPLED = ("backlash",)
_OF_LINKS = ("linkage_inertia", "linkage_gravity", "payload_mass", "link_length_error", "base_compliance")


@dataclass(frozen=True)
class DriveSide:
    """One drive at its output.

    Attributes:
        inertia: of the rotor [kg m^2].
        damping: [N m s/rad].
        gain: true torque over torque by the nominal constant.
        friction: dry friction, the same at any speed [N m].
        gap: whole play between drive and link [rad]; 0 for a rigid one.
        stiffness: of the flanks of that gap [N m/rad].
    """

    inertia: float = ACTUATOR_INERTIA
    damping: float = ACTUATOR_DAMPING
    gain: float = 1.0
    friction: float = 0.0
    gap: float = 0.0
    stiffness: float = 0.0

    @property
    def rigid(self) -> bool:
        """Return whether rotor and link are rigidly connected."""
        return self.stiffness == 0.0


def drive_side(hidden: Sequence[HiddenEffect], axis: str) -> DriveSide:
    """Return the drive of one axis of a leg with these hidden effects.

    What sits in the links is not the drive's and is passed over.

    Args:
        hidden: of the whole leg.
        axis: ``hip`` or ``knee``.

    Raises:
        InputError: an effect of this drive that a drive by itself cannot have here.
    """
    side = DriveSide()
    for effect in hidden:
        if effect.effect in _OF_LINKS or effect.axis != axis or effect.location != "actuator":
            continue
        if effect.effect not in (*_OWN, *_COUPLED):
            raise InputError(
                f"a drive by itself cannot hide '{effect.effect}'",
                remedy=f"hide {', '.join((*_OWN, *_COUPLED))}, or what sits in the links",
            )
        side = _with(side, effect)
    return side


def _with(side: DriveSide, effect: HiddenEffect) -> DriveSide:
    p = effect.parameters
    match effect.effect:
        case "torque_constant_error":
            return replace(side, gain=side.gain * p["gain"])
        case "coulomb_friction":
            return replace(side, friction=side.friction + p["torque"])
        case "viscous_damping":
            return replace(side, damping=side.damping + p["damping"])
        case "reflected_inertia":
            return replace(side, inertia=side.inertia + p["inertia"])
        case _ if p.get("damping"):
            raise InputError("flanks of a drive by itself are elastic", remedy="hide a gap without damping")
        case _:
            return replace(side, gap=p["gap"], stiffness=p["stiffness"])


class UsedDriveBench(VirtualBench):
    """The drive of a leg on the bench, with what it hides there; what is in the links is not on the bench.

    Args:
        hidden: effects of the leg that the drive was taken from.
        axis: of the leg, where the drive was.
        seed, sensors: as of the bench.

    Raises:
        InputError: the drive hides what the bench cannot have.
    """

    def __init__(
        self, hidden: Sequence[HiddenEffect], axis: str = "hip", seed: int = 0, sensors: Sensors | None = None
    ) -> None:
        super().__init__(seed, sensors)
        self._drive = drive_side(hidden, axis)

    def shaft(self, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return angle and speed (N,) at every row under measured torques (N,) [N m], held in between."""
        drive, (inertia, damping) = self._drive, shaft_constants()
        inertia += drive.inertia - ACTUATOR_INERTIA
        damping += drive.damping - ACTUATOR_DAMPING
        speed, angle = np.zeros(len(torque)), np.zeros(len(torque))
        q = w = 0.0
        for k in range(len(torque) - 1):
            true, left = drive.gain * float(torque[k]), ROW
            while left > 0.0:
                sign = np.sign(w) or np.sign(true)
                if w == 0.0 and abs(true) <= drive.friction:
                    break  # it sticks
                final, lag = (true - sign * drive.friction) / damping, inertia / damping
                # the speed w(t) = final + (w - final) exp(-t / lag) turns round where friction does
                stops = w != 0.0 and final * w < 0.0
                until = min(left, lag * log(1.0 - w / final)) if stops else left
                decay = exp(-until / lag)
                q += final * until + (w - final) * (1.0 - decay) * lag
                w = 0.0 if stops and until < left else final + (w - final) * decay
                left -= until
            angle[k + 1], speed[k + 1] = q, w
        return angle, speed


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
