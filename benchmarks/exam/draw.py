"""Draws several hidden effects at once that are not much the same."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from workbench.core import InputError
from workbench.rigs import DRAWN_EFFECTS, HiddenEffect
from workbench.rigs.draw import draw_from, seats_of
from workbench.rigs.magnitudes import Seat

#: Effects of one kind: on one axis, or where one has no axis, two of them are much the same thing.
_KINDS = (
    {
        "coulomb_friction",
        "stribeck_friction",
        "asymmetric_friction",
        "load_dependent_friction",
        "presliding_hysteresis",
    },
    {"viscous_damping", "quadratic_drag"},
    {
        "reflected_inertia",
        "linkage_inertia",
        "linkage_gravity",
        "payload_mass",
        "link_length_error",
        "parallel_spring",
    },
    {"command_delay", "sensor_delay", "current_loop_lag", "velocity_filter_lag"},
    {"torque_saturation", "speed_torque_limit"},
    {"torque_constant_error", "thermal_derating", "controller_gain_error"},
    {"backlash", "joint_compliance", "base_compliance"},
    {"torque_bias", "encoder_offset", "encoder_scale", "encoder_eccentricity"},
)
_DRY = _KINDS[0] - {"presliding_hysteresis"}
_MOST_DRY = 2  # that the rig can stick at


def draw_several(seed: int, count: int, effects: Collection[str] = DRAWN_EFFECTS) -> tuple[HiddenEffect, ...]:
    """Return two or three effects at different places that differ enough from each other.

    No place (axis and location, or the whole leg) is taken twice, and no two effects of one kind act on the
    same axis: an inertia and a payload, a command's and a sensor's delay.

    Args:
        seed: draws all of it.
        count: how many.
        effects: names to draw from.

    Raises:
        InputError: an effect that is never drawn, or too few of them to go together.
    """
    generator = np.random.default_rng([seed, 29])
    left, drawn = seats_of(effects), []
    for _ in range(count):
        if not left:
            raise InputError(
                f"no {count} of these effects can be combined", remedy="allow more of them, or draw fewer"
            )
        chosen = draw_from(left, generator)
        drawn.append(chosen)
        full = sum(each.effect in _DRY for each in drawn) == _MOST_DRY
        left = [seat for seat in left if not _clash(seat, chosen) and not (full and seat[0] in _DRY)]
    return tuple(drawn)


def _clash(seat: Seat, drawn: HiddenEffect) -> bool:
    """Whether a seat is taken by what is drawn, or would be much the same thing."""
    effect, axis, location = seat
    if (axis, location) == (drawn.axis, drawn.location):
        return True
    alike = effect == drawn.effect or any({effect, drawn.effect} <= kind for kind in _KINDS)
    return alike and (axis == drawn.axis or None in (axis, drawn.axis))
