"""The catalogue: every effect there is, in one tuple that anyone can read."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from workbench.core import EffectKey, InputError
from workbench.models import Model, Placement

from .actuator_inertia_coupling import ActuatorInertiaCoupling
from .asymmetric_friction import AsymmetricFriction
from .backlash import Backlash
from .base import Effect
from .base_compliance import BaseCompliance
from .cogging import Cogging
from .command_delay import CommandDelay
from .contact_compliance import ContactCompliance
from .controller_gain_error import ControllerGainError
from .coulomb_friction import CoulombFriction
from .current_loop_lag import CurrentLoopLag
from .encoder_eccentricity import EncoderEccentricity
from .encoder_offset import EncoderOffset
from .encoder_scale import EncoderScale
from .first_moment_error import FirstMomentError
from .ground_friction import GroundFriction
from .joint_compliance import JointCompliance
from .link_inertia_error import LinkInertiaError
from .link_length_error import LinkLengthError
from .linkage_coriolis import LinkageCoriolis
from .linkage_gravity import LinkageGravity
from .linkage_inertia import LinkageInertia
from .load_dependent_friction import LoadDependentFriction
from .parallel_spring import ParallelSpring
from .payload_mass import PayloadMass
from .presliding_hysteresis import PreslidingHysteresis
from .quadratic_drag import QuadraticDrag
from .reflected_inertia import ReflectedInertia
from .sensor_delay import SensorDelay
from .speed_torque_limit import SpeedTorqueLimit
from .stribeck_friction import StribeckFriction
from .thermal_derating import ThermalDerating
from .torque_bias import TorqueBias
from .torque_constant_error import TorqueConstantError
from .torque_saturation import TorqueSaturation
from .velocity_filter_lag import VelocityFilterLag
from .viscous_damping import ViscousDamping

EFFECTS: tuple[Effect, ...] = (
    ActuatorInertiaCoupling(),
    LinkageInertia(),
    LinkageGravity(),
    LinkageCoriolis(),
    ViscousDamping(),
    CoulombFriction(),
    ReflectedInertia(),
    PayloadMass(),
    FirstMomentError(),
    TorqueConstantError(),
    TorqueBias(),
    CommandDelay(),
    ParallelSpring(),
    AsymmetricFriction(),
    StribeckFriction(),
    LoadDependentFriction(),
    QuadraticDrag(),
    TorqueSaturation(),
    SpeedTorqueLimit(),
    Cogging(),
    EncoderOffset(),
    EncoderScale(),
    EncoderEccentricity(),
    SensorDelay(),
    VelocityFilterLag(),
    ControllerGainError(),
    CurrentLoopLag(),
    ThermalDerating(),
    PreslidingHysteresis(),
    JointCompliance(),
    Backlash(),
    BaseCompliance(),
    LinkInertiaError(),
    LinkLengthError(),
    ContactCompliance(),
    GroundFriction(),
)

_BY_NAME = {effect.name: effect for effect in EFFECTS}


def effect_named(name: str, file: Path | None = None) -> Effect:
    """The effect of this name; `file` is where it was named, for the error.

    Raises:
        InputError: there is none; says which are like it, or all.
    """
    if name not in _BY_NAME:
        known = sorted(_BY_NAME)
        near = get_close_matches(name, known) or [n for n in known if name and name in n]
        choice = f"did you mean {' or '.join(near)}?" if near else f"choose one of {', '.join(known)}"
        raise InputError(f"no effect is called '{name}'", file=file, remedy=choice)
    return _BY_NAME[name]


def places(model: Model) -> tuple[EffectKey, ...]:
    """Every effect in every place where it could be added to this model.

    An effect that the model has may be added once more where its parameters may be wrong: increments add up.
    """
    keys: list[EffectKey] = []
    for effect in EFFECTS:
        if effect.axes == "all":
            candidates = [EffectKey(effect.name, None)]
        else:
            candidates = [
                EffectKey(effect.name, axis, location)
                for index, axis in enumerate(model.driven)
                for location in effect.locations
                if location == "actuator" or _pin_differs(model, index)
            ]
        keys += [key for key in candidates if effect.applies(model, key)]
    return tuple(keys)


def _pin_differs(model: Model, index: int) -> bool:
    """Whether the pin of an axis moves otherwise than its drive."""
    row = model.transmission[index]
    return bool((row != [float(j == index) for j in range(model.size)]).any())


def giving_way(model: Model) -> list[tuple[Effect, Placement | None, dict[str, float]]]:
    """What lets a model's motors, links and base move apart: each effect, its place and nonlinear values."""
    split = [(effect_named(a.key.effect), a) for a in model.effects if effect_named(a.key.effect).splits]
    return [(e, Placement.of(model, a.key), e.to_coefficients(a.values)[1]) for e, a in split]


def contains(general: EffectKey, special: EffectKey) -> bool:
    """Whether an effect has another one as a special case in the same place."""
    effect = effect_named(general.effect)
    same = (general.axis, general.location) == (special.axis, special.location)
    return special.effect in effect.contains and (same or effect.axes == "all")
