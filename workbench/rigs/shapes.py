"""Parameters of an effect of a given magnitude."""

from __future__ import annotations

import numpy as np

from .experiments import HOLD
from .hidden import HiddenEffect
from .magnitudes import Seat


def hidden_effect(seat: Seat, magnitude: float, generator: np.random.Generator | None = None) -> HiddenEffect:
    """Return an effect of one magnitude: the first parameter below, which scales the others.

    Args:
        seat: effect, axis and location.
        magnitude: in the unit of that parameter; of an increment to the linkage, relative to nominal; of a
            factor, its distance from one; of a limit or a stiffness in series, its inverse, so that more is
            always more.
        generator: draws signs and the shape of effects with several parameters; None takes the middle.
    """
    effect, axis, location = seat
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
        case "quadratic_drag":
            return {"drag": magnitude}
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
        case "load_dependent_friction":
            return {"ratio": magnitude, "torque": magnitude * shape.between(0.2, 0.8)}
        case "presliding_hysteresis":
            slip = shape.between(0.004, 0.015)  # rad from rest to where Coulomb's level is all but reached
            return {"torque": magnitude, "stiffness": magnitude / slip}
        case "torque_bias":
            return {"torque": shape.sign() * magnitude}
        case "torque_constant_error":
            return {"gain": 1.0 + shape.sign() * magnitude}
        case "torque_saturation":
            return {"limit": 1.0 / magnitude}
        case "speed_torque_limit":
            return {"stall_torque": 1.0 / magnitude, "no_load_speed": shape.between(8.0, 16.0)}
        case "thermal_derating":
            return {"coefficient": magnitude, "time_constant": shape.between(8.0, 25.0)}
        case "cogging":
            order, phase = round(shape.between(6.0, 24.0)), shape.between(0.0, 2 * np.pi)
            return {"torque": magnitude, "order": float(order), "phase": phase}
        case "command_delay" | "sensor_delay":
            return {"time": magnitude}
        case "current_loop_lag" | "velocity_filter_lag":
            return {"time_constant": magnitude}
        case "controller_gain_error":
            kd = shape.sign() * magnitude * shape.between(0.5, 1.5)
            return {"kp_scale": 1.0 + shape.sign() * magnitude, "kd_scale": 1.0 + kd}
        case "reflected_inertia":
            return {"inertia": magnitude}
        case "payload_mass":
            return {"mass": magnitude}
        case "link_length_error":
            return {"length": shape.sign() * magnitude}
        case "parallel_spring":
            hold = _hold_angle(axis, location)
            return {"stiffness": magnitude, "rest": hold + shape.between(-0.4, 0.4)}
        case "joint_compliance":
            # damping over stiffness [s]: with less the loop drives modes near half its rate unstable
            return {"stiffness": 1.0 / magnitude, "damping": shape.between(1e-3, 2e-3) / magnitude}
        case "backlash":
            # half of them bounce; stiffer flanks ring near half the loop's rate, which makes them unstable
            stiffness, retardation = shape.between(250.0, 450.0), max(shape.between(-5e-3, 5e-3), 0.0)
            return {"gap": magnitude, "stiffness": stiffness, "damping": retardation * stiffness}
        case "base_compliance":
            mass, leg = shape.between(3.0, 8.0), 2.1  # kg
            damping = 2 * shape.between(0.02, 0.1) * float(np.sqrt((mass + leg) / magnitude))
            return {"stiffness": 1.0 / magnitude, "damping": damping, "mass": mass}
        case "encoder_offset":
            return {"angle": shape.sign() * magnitude}
        case "encoder_scale":
            return {"scale": 1.0 + shape.sign() * magnitude}
        case "encoder_eccentricity":
            return {"amplitude": magnitude, "phase": shape.between(0.0, 2 * np.pi)}
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
