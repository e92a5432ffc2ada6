"""Smallest and largest sizes of hidden effects."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

Seat = tuple[str, str | None, str]  # effect, axis, location

#: How many times its smallest magnitude an effect may reach.
SPAN = 6.0

_PLACES = ("hip", "actuator"), ("knee", "actuator"), ("knee", "joint")
#: Of effects without an axis one number; of the others one for each of the places, or for the first of them.
_SMALLEST: Mapping[str, float | tuple[float, ...]] = {
    "viscous_damping": (0.13, 0.066, 0.062),
    "coulomb_friction": (0.16, 0.11, 0.093),
    "stribeck_friction": (0.13, 0.091, 0.07),
    "asymmetric_friction": (0.14, 0.09, 0.076),
    "torque_bias": (0.16, 0.11),
    "torque_constant_error": (0.067, 0.072),
    "command_delay": 0.00022,
    "reflected_inertia": (0.0035, 0.0018),
    "payload_mass": 0.029,
    "parallel_spring": (0.75, 0.28, 0.32),
    "linkage_inertia": 0.22,
    "linkage_gravity": 1.2,
    "load_dependent_friction": (0.069, 0.07, 0.048),
    "presliding_hysteresis": (0.2, 0.13, 0.11),
    "quadratic_drag": (0.042, 0.017, 0.014),
    "torque_saturation": (0.17, 0.23),
    "speed_torque_limit": (0.023, 0.033),
    "thermal_derating": (0.0015, 0.0022),
    "cogging": (0.18, 0.13),
    "current_loop_lag": (0.00039, 0.00041),
    "sensor_delay": 0.00041,
    "velocity_filter_lag": (0.0008, 0.00082),
    "controller_gain_error": (0.069, 0.061),
    # gaps of 0.0005, 0.0003 and 0.0003 show already, but give less than their flanks do
    "backlash": (0.006, 0.004, 0.004),
    "joint_compliance": (0.00032, 0.0023, 0.0028),
    "encoder_offset": (0.037, 0.056),
    "encoder_scale": (0.049, 0.06),
    "encoder_eccentricity": (0.054, 0.068),
    "link_length_error": (0.042,),
    "base_compliance": 5.5e-06,
}

#: Smallest magnitude that is worth hiding: it doubles the nominal model's normalised error over the demo's
#: experiments, against what sensor noise alone makes. Found by simulating with and without the effect and
#: with and without noise (error of noise alone: 0.0206); benchmarks/hidden_magnitudes.py finds them again and
#: says which effects are measured otherwise. `hidden_effect` says what the number is of each effect. Of a
#: longer shank a fixed base feels nothing, so that it is never drawn.
SMALLEST: Mapping[Seat, float] = MappingProxyType(
    {
        (effect, axis, location): size
        for effect, sizes in _SMALLEST.items()
        for (axis, location), size in (
            zip(_PLACES, sizes, strict=False) if isinstance(sizes, tuple) else [((None, "actuator"), sizes)]
        )
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
