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
from . import hidden_plate as plate
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

EFFECTS: Mapping[str, Installer] = MappingProxyType(
    {
        "viscous_damping": motion.viscous_damping,
        "coulomb_friction": motion.coulomb_friction,
        "stribeck_friction": motion.stribeck_friction,
        "asymmetric_friction": motion.asymmetric_friction,
        "load_dependent_friction": motion.load_dependent_friction,
        "presliding_hysteresis": motion.presliding_hysteresis,
        "quadratic_drag": motion.quadratic_drag,
        "torque_constant_error": drive.torque_constant_error,
        "torque_bias": drive.torque_bias,
        "torque_saturation": drive.torque_saturation,
        "speed_torque_limit": drive.speed_torque_limit,
        "thermal_derating": drive.thermal_derating,
        "cogging": motion.cogging,
        "current_loop_lag": drive.current_loop_lag,
        "command_delay": drive.command_delay,
        "sensor_delay": sensing.sensor_delay,
        "velocity_filter_lag": sensing.velocity_filter_lag,
        "controller_gain_error": sensing.controller_gain_error,
        "backlash": flexible.backlash,
        "joint_compliance": flexible.joint_compliance,
        "reflected_inertia": drive.reflected_inertia,
        "linkage_inertia": drive.linkage_inertia,
        "linkage_gravity": drive.linkage_gravity,
        "payload_mass": drive.payload_mass,
        "parallel_spring": motion.parallel_spring,
        "encoder_offset": sensing.encoder_offset,
        "encoder_scale": sensing.encoder_scale,
        "encoder_eccentricity": sensing.encoder_eccentricity,
        "link_length_error": flexible.link_length_error,
        "base_compliance": flexible.base_compliance,
    }
)
OUTSIDERS: Mapping[str, Installer] = MappingProxyType(
    {
        "periodic_disturbance": drive.periodic_disturbance,
        "random_walk_torque": drive.random_walk_torque,
        "cubic_spring": motion.cubic_spring,
        "position_dependent_friction": motion.position_dependent_friction,
        "rough_patch": outside.rough_patch,
        "one_sided_spring": outside.one_sided_spring,
        "cross_spring": outside.cross_spring,
        "cross_damping": outside.cross_damping,
        "drifting_torque": outside.drifting_torque,
        "torque_hysteresis": outside.torque_hysteresis,
        "torque_deadband": outside.torque_deadband,
        "torque_dropout": outside.torque_dropout,
    }
)
WITHOUT_AXIS = frozenset(
    {
        "command_delay",
        "sensor_delay",
        "linkage_inertia",
        "linkage_gravity",
        "payload_mass",
        "base_compliance",
        "cross_spring",
        "contact_compliance",
        "ground_friction",
    }
)
AT_JOINTS = frozenset(
    {
        "viscous_damping",
        "coulomb_friction",
        "stribeck_friction",
        "asymmetric_friction",
        "load_dependent_friction",
        "presliding_hysteresis",
        "quadratic_drag",
        "backlash",
        "joint_compliance",
        "parallel_spring",
        "cubic_spring",
        "position_dependent_friction",
        "rough_patch",
        "one_sided_spring",
    }
)
#: Of a leg that stands on a plate.
ON_A_PLATE: Mapping[str, Installer] = MappingProxyType(
    {"contact_compliance": plate.contact_compliance, "ground_friction": plate.ground_friction}
)
_ALL: Mapping[str, Installer] = MappingProxyType({**EFFECTS, **ON_A_PLATE, **OUTSIDERS})
