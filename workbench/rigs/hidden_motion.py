"""Hidden effects that act on motion: springs, damping, friction; in a drive or in a joint."""

from __future__ import annotations

from math import copysign, exp, sin

from .friction import Friction, Level
from .machine import Machine
from .place import Passive, Place


def viscous_damping(machine: Machine, at: Place, *, damping: float) -> None:
    """-damping w, beyond the damping that the drive has."""
    machine.passive.append(Passive(at, lambda q, w: -damping * w))


def quadratic_drag(machine: Machine, at: Place, *, drag: float) -> None:
    """-drag w |w|."""
    machine.passive.append(Passive(at, lambda q, w: -drag * w * abs(w)))


def parallel_spring(machine: Machine, at: Place, *, stiffness: float, rest: float) -> None:
    """-stiffness (q - rest)."""
    machine.passive.append(Passive(at, lambda q, w: -stiffness * (q - rest)))


def cubic_spring(machine: Machine, at: Place, *, stiffness: float, rest: float) -> None:
    """-stiffness (q - rest)^3; an outsider."""
    machine.passive.append(Passive(at, lambda q, w: -stiffness * (q - rest) ** 3))


def cogging(machine: Machine, at: Place, *, torque: float, order: float, phase: float) -> None:
    """torque sin(order q + phase)."""
    machine.passive.append(Passive(at, lambda q, w: torque * sin(order * q + phase)))


def _rub(machine: Machine, at: Place, level: Level, load_axis: int | None = None) -> None:
    machine.frictions.append(Friction(at.direction, level, load_axis, at.at_pin))


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


def presliding_hysteresis(machine: Machine, at: Place, *, torque: float, stiffness: float) -> None:
    """Dahl: dz/dt = (stiffness / torque) w (1 - sign(w) z), and the torque is -torque z."""
    machine.hystereses.append((at, torque, stiffness))


def position_dependent_friction(
    machine: Machine, at: Place, *, torque: float, order: float, phase: float
) -> None:
    """Coulomb friction that comes and goes round the turn; an outsider."""
    _rub(machine, at, lambda w, q, load: torque * (1.0 + sin(order * q + phase)))
