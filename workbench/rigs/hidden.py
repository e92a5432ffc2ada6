"""Effects that the virtual leg can hide, and how each changes the machine.

Names and keys are those of the catalogue, the equations are written anew: an effect simulated by the lines
that later explain it would prove nothing. Outsiders are what no catalogue entry explains.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

from workbench.core import EffectKey, InputError

from . import hidden_drive as drive
from . import hidden_flexible as flexible
from . import hidden_motion as motion
from . import hidden_outside as outside
from . import hidden_sensing as sensing
from .machine import AXES, Machine
from .place import Place
from .unfit import unfit


@dataclass(frozen=True)
class HiddenEffect:
    """A physical effect of the rig that the nominal model does not contain.

    Attributes:
        effect: a name of `EFFECTS` or `OUTSIDERS`.
        axis: ``"hip"`` or ``"knee"``; None where the effect has no axis (payload, linkage, delays, stand).
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

    def __reduce__(self) -> tuple[Any, ...]:
        return HiddenEffect, (self.effect, self.axis, self.location, dict(self.parameters))

    @property
    def key(self) -> EffectKey:
        """Return the name in a finding: at the hip, pin and drive are the same place, the drive."""
        return EffectKey(self.effect, self.axis, "actuator" if self.axis == "hip" else self.location)

    @property
    def place(self) -> Place:
        """Return where it acts; the first motor if the effect has no axis."""
        at_pin = self.location == "joint"
        if self.axis != "knee":
            return Place(0, (1.0, 0.0), at_pin)  # the hip pin turns with motor 1
        return Place(1, (-1.0, 1.0) if at_pin else (0.0, 1.0), at_pin)


def install(effect: HiddenEffect, machine: Machine) -> None:
    """Add `effect` to `machine`.

    Raises:
        InputError: a parameter is missing or unknown.
    """
    if wrong := unfit(effect.effect, _ALL[effect.effect], effect.parameters):
        raise wrong
    _ALL[effect.effect](machine, effect.place, **effect.parameters)


Installer = Callable[..., None]


def _by_name(*installers: Installer) -> Mapping[str, Installer]:
    return MappingProxyType({each.__name__: each for each in installers})


EFFECTS = _by_name(
    motion.viscous_damping, motion.coulomb_friction, motion.stribeck_friction, motion.asymmetric_friction,
    motion.load_dependent_friction, motion.presliding_hysteresis, motion.quadratic_drag,
    drive.torque_constant_error, drive.torque_bias, drive.torque_saturation, drive.speed_torque_limit,
    drive.thermal_derating, motion.cogging, drive.current_loop_lag, drive.command_delay, sensing.sensor_delay,
    sensing.velocity_filter_lag, sensing.controller_gain_error, flexible.backlash, flexible.joint_compliance,
    drive.reflected_inertia, drive.linkage_inertia, drive.linkage_gravity, drive.payload_mass,
    motion.parallel_spring, sensing.encoder_offset, sensing.encoder_scale, sensing.encoder_eccentricity,
    flexible.link_length_error, flexible.base_compliance,
)  # fmt: skip
OUTSIDERS = _by_name(
    drive.periodic_disturbance, drive.random_walk_torque, motion.cubic_spring,
    motion.position_dependent_friction, outside.rough_patch, outside.one_sided_spring, outside.cross_spring,
    outside.cross_damping, outside.drifting_torque, outside.torque_hysteresis, outside.torque_deadband,
    outside.torque_dropout,
)  # fmt: skip
WITHOUT_AXIS = frozenset((
    "command_delay", "sensor_delay", "linkage_inertia", "linkage_gravity", "payload_mass", "base_compliance",
    "cross_spring", "contact_compliance", "ground_friction",
))  # fmt: skip
AT_JOINTS = frozenset((
    "viscous_damping", "coulomb_friction", "stribeck_friction", "asymmetric_friction",
    "load_dependent_friction", "presliding_hysteresis", "quadratic_drag", "backlash", "joint_compliance",
    "parallel_spring", "cubic_spring", "position_dependent_friction", "rough_patch", "one_sided_spring",
))  # fmt: skip
#: Of a leg that stands on a plate.
ON_A_PLATE = _by_name(flexible.contact_compliance, flexible.ground_friction)
_ALL: Mapping[str, Installer] = MappingProxyType({**EFFECTS, **ON_A_PLATE, **OUTSIDERS})
