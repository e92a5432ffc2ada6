"""Smallest and largest sizes of hidden effects."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

Seat = tuple[str, str | None, str]  # effect, axis, location

#: How many times its smallest magnitude an effect may reach.
SPAN = 6.0

#: Smallest magnitude that is worth hiding: it doubles the nominal model's normalised error over the demo's
#: experiments, against what sensor noise alone makes. Found by simulating with and without the effect and
#: with and without noise (error of noise alone: 0.0206); benchmarks/hidden_magnitudes.py finds them again and
#: says which effects are measured otherwise. `hidden_effect` says what the number is of each effect. Of a
#: longer shank a fixed base feels nothing, so that it is never drawn.
SMALLEST: Mapping[Seat, float] = MappingProxyType(
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
        ("load_dependent_friction", "hip", "actuator"): 0.069,
        ("load_dependent_friction", "knee", "actuator"): 0.07,
        ("load_dependent_friction", "knee", "joint"): 0.048,
        ("presliding_hysteresis", "hip", "actuator"): 0.2,
        ("presliding_hysteresis", "knee", "actuator"): 0.13,
        ("presliding_hysteresis", "knee", "joint"): 0.11,
        ("quadratic_drag", "hip", "actuator"): 0.042,
        ("quadratic_drag", "knee", "actuator"): 0.017,
        ("quadratic_drag", "knee", "joint"): 0.014,
        ("torque_saturation", "hip", "actuator"): 0.17,
        ("torque_saturation", "knee", "actuator"): 0.23,
        ("speed_torque_limit", "hip", "actuator"): 0.023,
        ("speed_torque_limit", "knee", "actuator"): 0.033,
        ("thermal_derating", "hip", "actuator"): 0.0015,
        ("thermal_derating", "knee", "actuator"): 0.0022,
        ("cogging", "hip", "actuator"): 0.18,
        ("cogging", "knee", "actuator"): 0.13,
        ("current_loop_lag", "hip", "actuator"): 0.00039,
        ("current_loop_lag", "knee", "actuator"): 0.00041,
        ("sensor_delay", None, "actuator"): 0.00041,
        ("velocity_filter_lag", "hip", "actuator"): 0.0008,
        ("velocity_filter_lag", "knee", "actuator"): 0.00082,
        ("controller_gain_error", "hip", "actuator"): 0.069,
        ("controller_gain_error", "knee", "actuator"): 0.061,
        # gaps of 0.0005, 0.0003 and 0.0003 show already, but give less than their flanks do
        ("backlash", "hip", "actuator"): 0.006,
        ("backlash", "knee", "actuator"): 0.004,
        ("backlash", "knee", "joint"): 0.004,
        ("joint_compliance", "hip", "actuator"): 0.00032,
        ("joint_compliance", "knee", "actuator"): 0.0023,
        ("joint_compliance", "knee", "joint"): 0.0028,
        ("encoder_offset", "hip", "actuator"): 0.037,
        ("encoder_offset", "knee", "actuator"): 0.056,
        ("encoder_scale", "hip", "actuator"): 0.049,
        ("encoder_scale", "knee", "actuator"): 0.06,
        ("encoder_eccentricity", "hip", "actuator"): 0.054,
        ("encoder_eccentricity", "knee", "actuator"): 0.068,
        ("link_length_error", "hip", "actuator"): 0.042,
        ("base_compliance", None, "actuator"): 5.5e-06,
    }
)

#: Largest magnitudes that are still physical where `SPAN` would go too far.
LARGEST: Mapping[str, float] = MappingProxyType(
    {
        "torque_constant_error": 0.3,
        "linkage_gravity": 3.0,
        "load_dependent_friction": 0.3,
        "torque_saturation": 0.4,  # 2.5 N m
        "cogging": 0.6,
        "sensor_delay": 1.5e-3,
        "current_loop_lag": 2e-3,
        "velocity_filter_lag": 4e-3,
        "controller_gain_error": 0.25,
        "encoder_offset": 0.15,
        "encoder_scale": 0.15,
        "encoder_eccentricity": 0.12,
        "link_length_error": 0.06,
    }
)

#: Every effect that can be drawn.
DRAWN_EFFECTS = tuple(sorted({effect for effect, _, _ in SMALLEST}))

#: What the demo hides: effects that its diagnosis knows and its six experiments show.
DEMO_EFFECTS = (
    "asymmetric_friction", "command_delay", "coulomb_friction", "linkage_gravity", "linkage_inertia",
    "parallel_spring", "payload_mass", "reflected_inertia", "stribeck_friction", "torque_bias",
    "torque_constant_error", "viscous_damping",
)  # fmt: skip
