"""Hidden effects that act on motion: springs, damping and dry friction, in a drive or in a joint."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, exp, sin

from .friction import Friction, Level
from .integrate import PassiveTorque
from .machine import Direction, Machine, Place


def _along(direction: Direction, law: Callable[[float, float], float]) -> PassiveTorque:
    """Torque in actuator coordinates of a `law` of position and speed along `direction`."""
    d1, d2 = direction

    def torque(q1: float, q2: float, v1: float, v2: float) -> tuple[float, float]:
        amount = law(d1 * q1 + d2 * q2, d1 * v1 + d2 * v2)
        return d1 * amount, d2 * amount

    return torque


def viscous_damping(machine: Machine, at: Place, *, damping: float) -> None:
    """-damping w, beyond the damping that the drive has."""
    machine.passive.append(_along(at.direction, lambda q, w: -damping * w))


def quadratic_drag(machine: Machine, at: Place, *, drag: float) -> None:
    """-drag w |w|."""
    machine.passive.append(_along(at.direction, lambda q, w: -drag * w * abs(w)))


def parallel_spring(machine: Machine, at: Place, *, stiffness: float, rest: float) -> None:
    """-stiffness (q - rest)."""
    machine.passive.append(_along(at.direction, lambda q, w: -stiffness * (q - rest)))


def cubic_spring(machine: Machine, at: Place, *, stiffness: float, rest: float) -> None:
    """-stiffness (q - rest)^3; an outsider."""
    machine.passive.append(_along(at.direction, lambda q, w: -stiffness * (q - rest) ** 3))


def cogging(machine: Machine, at: Place, *, torque: float, order: float, phase: float) -> None:
    """torque sin(order q + phase)."""
    machine.passive.append(_along(at.direction, lambda q, w: torque * sin(order * q + phase)))


def _rub(machine: Machine, at: Place, level: Level, load_axis: int | None = None) -> None:
    machine.frictions.append(Friction(at.direction, level, load_axis))


def coulomb_friction(machine: Machine, at: Place, *, torque: float) -> None:
    """The same torque at any speed and at rest."""
    _rub(machine, at, lambda w, q, load: torque)


def stribeck_friction(machine: Machine, at: Place, *, coulomb: float, static: float, speed: float) -> None:
    """From static at rest down to coulomb, as exp(-(w / speed)^2)."""
    _rub(machine, at, lambda w, q, load: coulomb + (static - coulomb) * exp(-((w / speed) ** 2)))


def asymmetric_friction(
    machine: Machine,
    at: Place,
    *,
    damping_positive: float,
    damping_negative: float,
    torque_positive: float,
    torque_negative: float,
) -> None:
    """Coulomb and viscous friction, each by direction of motion."""

    def level(w: float, q: float, load: float) -> float:
        forward = copysign(1.0, w) > 0
        return torque_positive + damping_positive * w if forward else torque_negative - damping_negative * w

    _rub(machine, at, level)


def load_dependent_friction(machine: Machine, at: Place, *, torque: float, ratio: float) -> None:
    """torque + ratio |motor torque|."""
    _rub(machine, at, lambda w, q, load: torque + ratio * load, load_axis=at.index)


def position_dependent_friction(
    machine: Machine, at: Place, *, torque: float, order: float, phase: float
) -> None:
    """Coulomb friction that comes and goes round the turn; an outsider."""
    _rub(machine, at, lambda w, q, load: torque * (1.0 + sin(order * q + phase)))
