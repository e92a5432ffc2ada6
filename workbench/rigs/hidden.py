"""Effects that the virtual leg can hide: what each does to the machine.

Names and keys are those of the catalogue, the equations are written here anew: an effect simulated by the lines
that later explain it would prove nothing. Below them stand outsiders, which no catalogue entry explains.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import copysign, exp, sin
from types import MappingProxyType
from typing import Literal

import numpy as np

from workbench.core import InputError

from .friction import Friction, Level
from .integrate import PassiveTorque
from .machine import AXES, Machine
from .structure import LegStructure, leg_structure

Direction = tuple[float, float]


@dataclass(frozen=True)
class HiddenEffect:
    """A physical effect that the rig has and the nominal model has not.

    Attributes:
        effect: a name of `EFFECTS` or `OUTSIDERS`.
        axis: ``"hip"`` or ``"knee"``; None where the effect has no axis (payload, linkage, delay).
        location: ``"actuator"`` (the drive) or ``"joint"`` (the pin between two links).
        parameters: keys of the catalogue, SI.

    Raises:
        InputError: unknown name, axis, place or parameter.
    """

    effect: str
    axis: str | None = None
    location: Literal["actuator", "joint"] = "actuator"
    parameters: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        if self.effect not in _ALL:
            raise InputError(
                f"the rig cannot hide '{self.effect}'", remedy=f"one of {', '.join(sorted(_ALL))}"
            )
        if self.axis not in (*AXES, None) or self.location not in ("actuator", "joint"):
            raise InputError(
                f"no such place: {self.axis}, {self.location}", remedy="hip or knee, actuator or joint"
            )
        if self.axis is None and self.effect not in WITHOUT_AXIS:
            raise InputError(f"'{self.effect}' acts on one axis", remedy="give axis = hip or knee")
        if self.location == "joint" and self.effect not in AT_JOINTS:
            raise InputError(f"'{self.effect}' cannot sit in a joint", remedy="location = actuator")

    @property
    def direction(self) -> Direction:
        """d with axis position = d . q and torque d times the axis torque, in actuator coordinates."""
        if self.axis != "knee":
            return 1.0, 0.0  # the hip pin turns with motor 1
        return (0.0, 1.0) if self.location == "actuator" else (-1.0, 1.0)

    @property
    def index(self) -> int:
        """Index of the axis."""
        return AXES.index(self.axis or "hip")


def install(effect: HiddenEffect, machine: Machine) -> None:
    """Puts `effect` into `machine`.

    Raises:
        InputError: a parameter is missing or unknown.
    """
    try:
        _ALL[effect.effect](machine, effect, **effect.parameters)
    except TypeError as error:
        raise InputError(
            f"parameters of '{effect.effect}' do not fit: {error}", remedy="see the catalogue"
        ) from error


# --- smooth torques ---------------------------------------------------------------------------------------------


def _along(direction: Direction, law: Callable[[float, float], float]) -> PassiveTorque:
    """Torque in actuator coordinates of a `law` of position and speed along `direction`."""
    d1, d2 = direction

    def torque(q1: float, q2: float, v1: float, v2: float) -> tuple[float, float]:
        amount = law(d1 * q1 + d2 * q2, d1 * v1 + d2 * v2)
        return d1 * amount, d2 * amount

    return torque


def _viscous_damping(machine: Machine, at: HiddenEffect, *, damping: float) -> None:
    machine.passive.append(_along(at.direction, lambda q, w: -damping * w))


def _quadratic_drag(machine: Machine, at: HiddenEffect, *, drag: float) -> None:
    machine.passive.append(_along(at.direction, lambda q, w: -drag * w * abs(w)))


def _parallel_spring(machine: Machine, at: HiddenEffect, *, stiffness: float, rest: float) -> None:
    machine.passive.append(_along(at.direction, lambda q, w: -stiffness * (q - rest)))


def _cubic_spring(machine: Machine, at: HiddenEffect, *, stiffness: float, rest: float) -> None:
    machine.passive.append(_along(at.direction, lambda q, w: -stiffness * (q - rest) ** 3))


def _cogging(machine: Machine, at: HiddenEffect, *, torque: float, order: float, phase: float) -> None:
    machine.passive.append(_along(at.direction, lambda q, w: torque * sin(order * q + phase)))


# --- dry friction -----------------------------------------------------------------------------------------------


def _rub(machine: Machine, at: HiddenEffect, level: Level, load_axis: int | None = None) -> None:
    machine.frictions.append(Friction(at.direction, level, load_axis))


def _coulomb_friction(machine: Machine, at: HiddenEffect, *, torque: float) -> None:
    _rub(machine, at, lambda w, q, load: torque)


def _stribeck_friction(
    machine: Machine, at: HiddenEffect, *, coulomb: float, static: float, speed: float
) -> None:
    _rub(machine, at, lambda w, q, load: coulomb + (static - coulomb) * exp(-((w / speed) ** 2)))


def _asymmetric_friction(
    machine: Machine,
    at: HiddenEffect,
    *,
    damping_positive: float,
    damping_negative: float,
    torque_positive: float,
    torque_negative: float,
) -> None:
    def level(w: float, q: float, load: float) -> float:
        forward = copysign(1.0, w) > 0
        return torque_positive + damping_positive * w if forward else torque_negative - damping_negative * w

    _rub(machine, at, level)


def _load_dependent_friction(machine: Machine, at: HiddenEffect, *, torque: float, ratio: float) -> None:
    _rub(machine, at, lambda w, q, load: torque + ratio * load, load_axis=at.index)


def _position_dependent_friction(
    machine: Machine, at: HiddenEffect, *, torque: float, order: float, phase: float
) -> None:
    _rub(machine, at, lambda w, q, load: torque * (1.0 + sin(order * q + phase)))


# --- torque chain -----------------------------------------------------------------------------------------------


def _torque_bias(machine: Machine, at: HiddenEffect, *, torque: float) -> None:
    machine.bias[at.index] += torque


def _torque_constant_error(machine: Machine, at: HiddenEffect, *, gain: float) -> None:
    machine.gain[at.index] *= gain


def _command_delay(machine: Machine, at: HiddenEffect, *, time: float) -> None:
    machine.delay += time


def _current_loop_lag(machine: Machine, at: HiddenEffect, *, time_constant: float) -> None:
    machine.lag[at.index] = time_constant


def _torque_saturation(machine: Machine, at: HiddenEffect, *, limit: float) -> None:
    machine.limit[at.index] = min(machine.limit[at.index], limit)


def _periodic_disturbance(
    machine: Machine, at: HiddenEffect, *, torque: float, frequency: float, phase: float
) -> None:
    def disturbance(t: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        return torque * np.sin(2 * np.pi * frequency * t + phase)

    machine.disturbances.append((at.index, disturbance))


def _random_walk_torque(machine: Machine, at: HiddenEffect, *, torque: float, time_constant: float) -> None:
    """A walk pulled back to zero (Ornstein-Uhlenbeck), so that `torque` is its RMS however long the run."""

    def disturbance(t: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        kept = np.exp(-(t[1] - t[0]) / time_constant)
        kicks = generator.standard_normal(len(t)) * torque * np.sqrt(1 - kept**2)
        walk, value = np.empty(len(t)), torque * generator.standard_normal()
        for row, kick in enumerate(kicks):
            walk[row] = value
            value = kept * value + kick
        return walk

    machine.disturbances.append((at.index, disturbance))


# --- inertia and gravity ----------------------------------------------------------------------------------------


def _reflected_inertia(machine: Machine, at: HiddenEffect, *, inertia: float) -> None:
    machine.structure = machine.structure.plus(**{("m11", "m22")[at.index]: inertia})


def _linkage_inertia(machine: Machine, at: HiddenEffect, *, M11: float, M12: float, M22: float) -> None:
    machine.structure = machine.structure.plus(m11=M11, m12=M12, m22=M22)


def _linkage_gravity(machine: Machine, at: HiddenEffect, *, g1: float, g2: float) -> None:
    machine.structure = machine.structure.plus(g1=g1, g2=g2)


def _payload_mass(machine: Machine, at: HiddenEffect, *, mass: float) -> None:
    """The mass rides on the foot of the Drake model; what it adds there is added here."""
    bare, loaded = vars(leg_structure()), vars(leg_structure(mass))
    added = LegStructure(**{key: loaded[key] - bare[key] for key in bare})
    machine.structure = machine.structure.plus(**vars(added))


Installer = Callable[..., None]

EFFECTS: Mapping[str, Installer] = MappingProxyType(
    {
        "viscous_damping": _viscous_damping,
        "coulomb_friction": _coulomb_friction,
        "stribeck_friction": _stribeck_friction,
        "asymmetric_friction": _asymmetric_friction,
        "load_dependent_friction": _load_dependent_friction,
        "quadratic_drag": _quadratic_drag,
        "torque_constant_error": _torque_constant_error,
        "torque_bias": _torque_bias,
        "torque_saturation": _torque_saturation,
        "cogging": _cogging,
        "current_loop_lag": _current_loop_lag,
        "command_delay": _command_delay,
        "reflected_inertia": _reflected_inertia,
        "linkage_inertia": _linkage_inertia,
        "linkage_gravity": _linkage_gravity,
        "payload_mass": _payload_mass,
        "parallel_spring": _parallel_spring,
    }
)
OUTSIDERS: Mapping[str, Installer] = MappingProxyType(
    {
        "periodic_disturbance": _periodic_disturbance,
        "random_walk_torque": _random_walk_torque,
        "cubic_spring": _cubic_spring,
        "position_dependent_friction": _position_dependent_friction,
    }
)
WITHOUT_AXIS = frozenset({"command_delay", "linkage_inertia", "linkage_gravity", "payload_mass"})
AT_JOINTS = frozenset(
    {
        "viscous_damping",
        "coulomb_friction",
        "stribeck_friction",
        "asymmetric_friction",
        "quadratic_drag",
        "parallel_spring",
        "cubic_spring",
        "position_dependent_friction",
    }
)
_ALL: Mapping[str, Installer] = MappingProxyType({**EFFECTS, **OUTSIDERS})
