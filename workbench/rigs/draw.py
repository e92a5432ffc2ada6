"""Draws what the demo hides: which effect, where, how large."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from .experiments import HOLD
from .hidden import HiddenEffect

Place = tuple[str, str | None, str]  # effect, axis, location

#: How many times its smallest magnitude an effect may reach.
SPAN = 6.0

#: Smallest magnitude that is worth hiding: it doubles the nominal model's normalised error over the demo's
#: experiments, against what sensor noise alone makes. Found by simulating with and without the effect and
#: with and without noise (error of noise alone: 0.0206); benchmarks/hidden_magnitudes.py finds them again.
SMALLEST: Mapping[Place, float] = MappingProxyType(
    {
        ("viscous_damping", "hip", "actuator"): 0.13,
        ("viscous_damping", "knee", "actuator"): 0.066,
        ("viscous_damping", "knee", "joint"): 0.062,
        ("coulomb_friction", "hip", "actuator"): 0.16,
        ("coulomb_friction", "knee", "actuator"): 0.11,
        ("coulomb_friction", "knee", "joint"): 0.093,
        ("stribeck_friction", "hip", "actuator"): 0.13,
        ("stribeck_friction", "knee", "actuator"): 0.091,
        ("stribeck_friction", "knee", "joint"): 0.07,
        ("asymmetric_friction", "hip", "actuator"): 0.14,
        ("asymmetric_friction", "knee", "actuator"): 0.09,
        ("asymmetric_friction", "knee", "joint"): 0.076,
        ("torque_bias", "hip", "actuator"): 0.16,
        ("torque_bias", "knee", "actuator"): 0.11,
        ("torque_constant_error", "hip", "actuator"): 0.067,
        ("torque_constant_error", "knee", "actuator"): 0.072,
        ("command_delay", None, "actuator"): 0.00022,
        ("reflected_inertia", "hip", "actuator"): 0.0035,
        ("reflected_inertia", "knee", "actuator"): 0.0018,
        ("payload_mass", None, "actuator"): 0.029,
        ("parallel_spring", "hip", "actuator"): 0.75,
        ("parallel_spring", "knee", "actuator"): 0.28,
        ("parallel_spring", "knee", "joint"): 0.32,
        ("linkage_inertia", None, "actuator"): 0.22,
        ("linkage_gravity", None, "actuator"): 1.2,
    }
)

#: Largest magnitudes that are still physical where `SPAN` would go too far.
LARGEST: Mapping[str, float] = MappingProxyType({"torque_constant_error": 0.3, "linkage_gravity": 3.0})


def draw_hidden(seed: int) -> HiddenEffect:
    """One effect with a magnitude log-uniform from clearly visible to `SPAN` times that.

    Every effect is as likely as any other, then every place where it can sit.
    """
    generator = np.random.default_rng([seed, 23])
    effects = sorted({effect for effect, _, _ in SMALLEST})
    chosen = effects[generator.integers(len(effects))]
    places = [place for place in SMALLEST if place[0] == chosen]
    place = places[generator.integers(len(places))]
    low, high = magnitude_range(place)
    return hidden_effect(place, float(np.exp(generator.uniform(np.log(low), np.log(high)))), generator)


def magnitude_range(place: Place) -> tuple[float, float]:
    """Smallest and largest magnitude that `draw_hidden` draws at `place`, in the unit of `hidden_effect`."""
    low = SMALLEST[place]
    return low, min(SPAN * low, LARGEST.get(place[0], np.inf))


def hidden_effect(
    place: Place, magnitude: float, generator: np.random.Generator | None = None
) -> HiddenEffect:
    """An effect of one magnitude: the first parameter below, by which the others scale.

    Args:
        place: effect, axis and location.
        magnitude: in the unit of that parameter; of an increment to the linkage, relative to nominal.
        generator: draws signs and the shape of effects with several parameters; None takes the middle.
    """
    effect, axis, location = place
    parameters = _parameters(effect, axis, location, magnitude, _Shape(generator))
    return HiddenEffect(effect, axis, "joint" if location == "joint" else "actuator", parameters)


class _Shape:
    """Random shape of an effect, or the middle of every interval."""

    def __init__(self, generator: np.random.Generator | None) -> None:
        self._generator = generator

    def between(self, low: float, high: float) -> float:
        return 0.5 * (low + high) if self._generator is None else float(self._generator.uniform(low, high))

    def sign(self) -> float:
        return 1.0 if self._generator is None else float(self._generator.choice([-1.0, 1.0]))


def _parameters(
    effect: str, axis: str | None, location: str, magnitude: float, shape: _Shape
) -> dict[str, float]:
    match effect:
        case "viscous_damping":
            return {"damping": magnitude}
        case "coulomb_friction":
            return {"torque": magnitude}
        case "stribeck_friction":
            static = magnitude * shape.between(1.4, 2.2)
            return {"coulomb": magnitude, "static": static, "speed": shape.between(0.1, 0.4)}
        case "asymmetric_friction":
            uneven = shape.sign() * shape.between(0.3, 0.6)
            damping = 0.1 * magnitude  # N m s/rad a N m: a tenth of the friction at 1 rad/s
            return {
                "damping_positive": damping * (1 + uneven),
                "damping_negative": damping * (1 - uneven),
                "torque_positive": magnitude * (1 + uneven),
                "torque_negative": magnitude * (1 - uneven),
            }
        case "torque_bias":
            return {"torque": shape.sign() * magnitude}
        case "torque_constant_error":
            return {"gain": 1.0 + shape.sign() * magnitude}
        case "command_delay":
            return {"time": magnitude}
        case "reflected_inertia":
            return {"inertia": magnitude}
        case "payload_mass":
            return {"mass": magnitude}
        case "parallel_spring":
            hold = _hold_angle(axis, location)
            return {"stiffness": magnitude, "rest": hold + shape.between(-0.4, 0.4)}
        case "linkage_inertia":
            sizes = {"M11": 0.00967, "M12": 0.002893, "M22": 0.00516}  # kg m^2, of the reference leg
        case "linkage_gravity":
            sizes = {"g1": 0.163091, "g2": 0.132743}  # N m, of the reference leg
        case _:
            raise KeyError(effect)
    return {name: magnitude * size * shape.between(0.7, 1.3) for name, size in sizes.items()}


def _hold_angle(axis: str | None, location: str) -> float:
    """Angle of an axis in the hold posture [rad]."""
    hip, knee = HOLD
    if axis == "hip":
        return float(hip)
    return float(knee if location == "joint" else hip + knee)
