"""Hidden effects that no catalogue entry explains: what an honest diagnosis has to leave unexplained."""

from __future__ import annotations

from collections.abc import Callable
from math import exp

import numpy as np

from .friction import Friction
from .machine import Machine
from .place import Passive, Place

_BOTH_MOTORS = Place(0, (1.0, 1.0))


def rough_patch(machine: Machine, at: Place, *, torque: float, angle: float, width: float) -> None:
    """Coulomb friction about one angle only, torque exp(-((q - angle) / width)^2)."""
    machine.frictions.append(
        Friction(
            at.direction, lambda w, q, load: torque * exp(-(((q - angle) / width) ** 2)), at_pin=at.at_pin
        )
    )


def one_sided_spring(machine: Machine, at: Place, *, stiffness: float, rest: float) -> None:
    """A strap that goes taut: -stiffness (q - rest) beyond rest, nothing before it."""
    machine.passive.append(Passive(at, lambda q, w: -stiffness * max(q - rest, 0.0)))


def cross_spring(machine: Machine, at: Place, *, stiffness: float, rest: float) -> None:
    """A spring from motor to motor that winds up by the sum of their angles: -stiffness (q1 + q2 - rest)."""
    machine.passive.append(Passive(_BOTH_MOTORS, lambda q, w: -stiffness * (q - rest)))


def cross_damping(machine: Machine, at: Place, *, damping: float) -> None:
    """-damping times the speed of the other motor."""
    other = (0.0, 1.0) if at.index == 0 else (1.0, 0.0)
    machine.passive.append(Passive(at, lambda q, w: -damping * w, feels=other))


def drifting_torque(machine: Machine, at: Place, *, torque: float, time: float) -> None:
    """A bias that starts anywhere and changes evenly: torque (a + b t / time), a and b normal, each run."""

    def drift(t: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        start, slope = generator.standard_normal(2)
        return torque * (start + slope * t / time)

    machine.disturbances.append((at.index, drift))


def torque_hysteresis(machine: Machine, at: Place, *, torque: float) -> None:
    """The drive keeps its torque until the measured one is `torque` away, and then follows at that distance.

    The play operator: what magnetised iron, or friction that grows with the load of a gear, makes of torque.
    """

    def play(generator: np.random.Generator) -> Callable[[float, float], float]:
        kept = 0.0

        def follow(asked: float, duration: float) -> float:
            nonlocal kept
            kept = min(max(kept, asked - torque), asked + torque)
            return kept

        return follow

    machine.reshaped.append((at.index, play))


def torque_deadband(machine: Machine, at: Place, *, torque: float) -> None:
    """Of the measured torque the first `torque` is lost, either way."""

    def lost(generator: np.random.Generator) -> Callable[[float, float], float]:
        return lambda asked, duration: asked - min(max(asked, -torque), torque)

    machine.reshaped.append((at.index, lost))


def torque_dropout(machine: Machine, at: Place, *, interval: float, duration: float) -> None:
    """Now and then there is no torque for `duration` [s], though it is measured; a loose contact.

    The times between are exponential, with mean `interval` [s].
    """

    def contact(generator: np.random.Generator) -> Callable[[float, float], float]:
        closed, left = True, float(generator.exponential(interval))

        def through(asked: float, part: float) -> float:
            nonlocal closed, left
            passed = asked if closed else 0.0
            left -= part
            if left <= 0.0:
                closed = not closed
                left = float(generator.exponential(interval)) if closed else duration
            return passed

        return through

    machine.reshaped.append((at.index, contact))
