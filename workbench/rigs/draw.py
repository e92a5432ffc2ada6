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
#: with and without noise; benchmarks/hidden_magnitudes.py finds them again.
SMALLEST: Mapping[Place, float] = MappingProxyType({})

#: Largest magnitudes that are still physical where `SPAN` would go too far.
LARGEST: Mapping[str, float] = MappingProxyType({"torque_constant_error": 0.3, "command_delay": 3e-3})


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
