"""An effect of one size in the second leg: which parameters it then has, by ranges of this leg's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from .hidden import Hidden

Seat = tuple[str, str | None, str]  # effect, axis, location

_HOLD = {("hip", "actuator"): -0.52, ("knee", "actuator"): 0.63, ("knee", "joint"): 1.15}  # about where it is


class Draw:
    """Random numbers; without a generator the middle of every range."""

    def __init__(self, generator: np.random.Generator | None = None) -> None:
        self._generator = generator

    def between(self, low: float, high: float) -> float:
        """Evenly from `low` to `high`."""
        return 0.5 * (low + high) if self._generator is None else float(self._generator.uniform(low, high))

    def log(self, low: float, high: float) -> float:
        """Evenly in the logarithm."""
        return float(np.exp(self.between(np.log(low), np.log(high))))

    def sign(self) -> float:
        """Either sign."""
        return 1.0 if self._generator is None else float(self._generator.choice([-1.0, 1.0]))


def hidden_of(seat: Seat, size: float, draw: Draw) -> Hidden:
    """The effect at a place with this first parameter; of a limit or a spring in series its inverse.

    Args:
        seat: effect, axis, location.
        size: of a factor its distance from one, of the linkage's increments relative to the leg's own.
        draw: signs, and all parameters but the first.
    """
    effect, axis, location = seat
    at = _HOLD.get((axis or "hip", location), 0.0)
    return Hidden(
        effect, axis, "joint" if location == "joint" else "actuator", _SHAPES[effect](size, draw, at)
    )


def _uneven(f: float, d: Draw, at: float) -> dict[str, float]:
    more, wet = d.sign() * d.between(0.25, 0.7), f * d.between(0.05, 0.2)
    up, down = 1 + more, 1 - more
    return {
        "damping_positive": wet * up,
        "damping_negative": wet * down,
        "torque_positive": f * up,
        "torque_negative": f * down,
    }


def _stribeck(f: float, d: Draw, at: float) -> dict[str, float]:
    return {"coulomb": f, "static": f * d.between(1.3, 2.4), "speed": d.log(0.08, 0.5)}


def _spring(k: float, d: Draw, at: float) -> dict[str, float]:
    return {"stiffness": k, "rest": at + d.between(-0.5, 0.5)}


def _gains(e: float, d: Draw, at: float) -> dict[str, float]:
    return {"kp_scale": 1 + d.sign() * e, "kd_scale": 1 + d.sign() * e * d.between(0.6, 1.3)}


def _linkage(keys: Mapping[str, float]) -> Callable[[float, Draw, float], dict[str, float]]:
    return lambda e, d, at: {key: e * of * d.between(0.6, 1.4) for key, of in keys.items()}


def _gap(g: float, d: Draw, at: float) -> dict[str, float]:
    stiffness = d.log(250.0, 450.0)
    return {"gap": g, "stiffness": stiffness, "damping": stiffness * d.between(0.5e-3, 4e-3)}


_SHAPES: Mapping[str, Callable[[float, Draw, float], dict[str, float]]] = {
    "viscous_damping": lambda x, d, at: {"damping": x},
    "quadratic_drag": lambda x, d, at: {"drag": x},
    "coulomb_friction": lambda x, d, at: {"torque": x},
    "stribeck_friction": _stribeck,
    "asymmetric_friction": _uneven,
    "load_dependent_friction": lambda x, d, at: {"ratio": x, "torque": x * d.between(0.15, 0.7)},
    "presliding_hysteresis": lambda x, d, at: {"torque": x, "stiffness": x / d.log(0.004, 0.02)},
    "torque_constant_error": lambda x, d, at: {"gain": 1 + d.sign() * x},
    "torque_bias": lambda x, d, at: {"torque": d.sign() * x},
    "torque_saturation": lambda x, d, at: {"limit": 1 / x},
    "speed_torque_limit": lambda x, d, at: {"stall_torque": 1 / x, "no_load_speed": d.between(7.0, 14.0)},
    "cogging": lambda x, d, at: {
        "torque": x,
        "order": float(round(d.between(5, 26))),
        "phase": d.between(0, 6.28),
    },
    "current_loop_lag": lambda x, d, at: {"time_constant": x},
    "velocity_filter_lag": lambda x, d, at: {"time_constant": x},
    "command_delay": lambda x, d, at: {"time": x},
    "sensor_delay": lambda x, d, at: {"time": x},
    "controller_gain_error": _gains,
    "reflected_inertia": lambda x, d, at: {"inertia": x},
    "payload_mass": lambda x, d, at: {"mass": x},
    "parallel_spring": _spring,
    "linkage_inertia": _linkage({"M11": 0.00967, "M12": 0.002893, "M22": 0.00516}),
    "linkage_gravity": _linkage({"g1": 0.163091, "g2": 0.132743}),
    "encoder_offset": lambda x, d, at: {"angle": d.sign() * x},
    "encoder_scale": lambda x, d, at: {"scale": 1 + d.sign() * x},
    "encoder_eccentricity": lambda x, d, at: {"amplitude": x, "phase": d.between(0, 6.28)},
    "joint_compliance": lambda x, d, at: {"stiffness": 1 / x, "damping": d.between(1e-3, 2e-3) / x},
    "backlash": _gap,
    "hum": lambda x, d, at: {
        "torque": x,
        "frequency": d.log(0.8, 9.0),
        "beat": d.log(0.1, 0.4),
        "phase": d.between(0, 6.28),
    },
    "random_walk_torque": lambda x, d, at: {"torque": x, "time_constant": d.log(0.1, 0.8)},
    "cubic_spring": lambda x, d, at: {"stiffness": x, "rest": at + d.between(-0.3, 0.3)},
    "one_sided_spring": lambda x, d, at: {"stiffness": x, "rest": at + d.between(-0.12, 0.12)},
    "position_dependent_friction": lambda x, d, at: {
        "torque": x,
        "order": d.between(4, 9),
        "phase": d.between(0, 6.28),
    },
    "detent": lambda x, d, at: {"torque": x, "angle": at + d.between(-0.1, 0.1), "width": d.log(0.03, 0.1)},
    "cross_damping": lambda x, d, at: {"damping": d.sign() * x},
}
