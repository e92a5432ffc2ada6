"""The catalogue: every effect there is, in one list that anyone can read."""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path

from workbench.core import EffectKey, InputError
from workbench.models import Model, Placement

from .base import Effect
from .compliance import Compliance
from .contact import OnGround
from .kinds import of_mass, on_links

#: Each is a file of its name, with a class of its name.
_NAMES = (
    "actuator_inertia_coupling",
    "linkage_inertia",
    "linkage_gravity",
    "linkage_coriolis",
    "viscous_damping",
    "coulomb_friction",
    "reflected_inertia",
    "payload_mass",
    "first_moment_error",
    "torque_constant_error",
    "torque_bias",
    "command_delay",
    "parallel_spring",
    "asymmetric_friction",
    "stribeck_friction",
    "load_dependent_friction",
    "quadratic_drag",
    "torque_saturation",
    "speed_torque_limit",
    "cogging",
    "encoder_offset",
    "encoder_scale",
    "encoder_eccentricity",
    "sensor_delay",
    "velocity_filter_lag",
    "controller_gain_error",
    "current_loop_lag",
    "thermal_derating",
    "presliding_hysteresis",
    "joint_compliance",
    "backlash",
    "base_compliance",
    "link_inertia_error",
    "link_length_error",
    "contact_compliance",
    "ground_friction",
)


def _effect(name: str) -> Effect:
    kind = name.title().replace("_", "")
    return getattr(import_module(f".{name}", __package__), kind)()


EFFECTS: tuple[Effect, ...] = tuple(map(_effect, _NAMES))

_BY_NAME = {effect.name: effect for effect in EFFECTS}


def effect_named(name: str, file: Path | None = None) -> Effect:
    """Return the effect of this name; `file` is where it was named, for the error.

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
    """Return every effect in every place where it could be added to this model.

    An effect that the model has may be added once more where its parameters may be wrong: increments add up.
    One that repeats is then another one of its kind.
    """
    keys: list[EffectKey] = []
    for effect in EFFECTS:
        if not effect.locations:
            candidates = [EffectKey(effect.name, None, site=effect.site(model))]
        else:
            candidates = [
                EffectKey(effect.name, axis, location)
                for index, axis in enumerate(model.driven)
                for location in effect.locations
                if location == "actuator" or _pin_differs(model, index)
            ]
        if effect.search.repeats:
            candidates = [
                replace(key, copy=1 + sum(key.same_place(a.key) for a in model.effects)) for key in candidates
            ]
        keys += [key for key in candidates if effect.applies(model, key) and _reached(effect, model)]
    return tuple(keys)


def _reached(effect: Effect, model: Model) -> bool:
    """Whether an effect acts on what a model has: links that are carried may weigh otherwise, but no more."""
    of_links = on_links(effect) or isinstance(effect, Compliance | OnGround)
    return model.carried is None or of_mass(effect) or not of_links


def _pin_differs(model: Model, index: int) -> bool:
    """Whether the pin of an axis moves otherwise than its drive."""
    row = model.transmission[index]
    return bool((row != [float(j == index) for j in range(model.size)]).any())


def giving_way(model: Model) -> list[tuple[Compliance, Placement | None, dict[str, float]]]:
    """Return effects that let motors, links and base move relative to each other: effect, place and
    nonlinear values.
    """
    known = [(effect_named(a.key.effect), a) for a in model.effects]
    return [
        (e, Placement.of(model, a.key), e.parameters.to_coefficients(a.values)[1])
        for e, a in known
        if isinstance(e, Compliance)
    ]


def contains(general: EffectKey, special: EffectKey) -> bool:
    """Return whether an effect has another one as a special case in the same place."""
    effect = effect_named(general.effect)
    same = (general.axis, general.location) == (special.axis, special.location)
    return special.effect in effect.search.contains and (same or not effect.locations)
