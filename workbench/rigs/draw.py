"""Draws hidden effects: which, where, how large."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from workbench.core import InputError

from .hidden import HiddenEffect
from .magnitudes import DEMO_EFFECTS, LARGEST, SMALLEST, SPAN, Seat
from .shapes import hidden_effect

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


def draw_hidden(seed: int, effects: Collection[str] = DEMO_EFFECTS) -> HiddenEffect:
    """Return one effect with a magnitude log-uniform between clearly visible and `SPAN` times that.

    Every effect is as likely as any other, then every place where it can sit.

    Args:
        seed: draws all of it.
        effects: names to draw from; `DRAWN_EFFECTS` are all that there are.

    Raises:
        InputError: an effect that is never drawn.
    """
    generator = np.random.default_rng([seed, 23])
    return _draw(_seats(effects), generator)


def draw_several(seed: int, count: int, effects: Collection[str] = DEMO_EFFECTS) -> tuple[HiddenEffect, ...]:
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
    left, drawn = _seats(effects), []
    for _ in range(count):
        if not left:
            raise InputError(
                f"no {count} of these effects can be combined", remedy="allow more of them, or draw fewer"
            )
        chosen = _draw(left, generator)
        drawn.append(chosen)
        full = sum(each.effect in _DRY for each in drawn) == _MOST_DRY
        left = [seat for seat in left if not _clash(seat, chosen) and not (full and seat[0] in _DRY)]
    return tuple(drawn)


def magnitude_range(seat: Seat) -> tuple[float, float]:
    """Return smallest and largest drawn magnitude at `seat`, in the unit of `hidden_effect`."""
    low = SMALLEST[seat]
    return low, max(low, min(SPAN * low, LARGEST.get(seat[0], np.inf)))


def _seats(effects: Collection[str]) -> list[Seat]:
    """Every seat of these effects.

    Raises:
        InputError: there is none of one of them.
    """
    for name in set(effects) - {effect for effect, _, _ in SMALLEST}:
        raise InputError(f"'{name}' is never drawn", remedy="see workbench.rigs.DRAWN_EFFECTS")
    return [seat for seat in SMALLEST if seat[0] in effects]


def _draw(seats: list[Seat], generator: np.random.Generator) -> HiddenEffect:
    names = sorted({effect for effect, _, _ in seats})
    chosen = names[generator.integers(len(names))]
    own = [seat for seat in seats if seat[0] == chosen]
    seat = own[generator.integers(len(own))]
    low, high = magnitude_range(seat)
    return hidden_effect(seat, float(np.exp(generator.uniform(np.log(low), np.log(high)))), generator)


def _clash(seat: Seat, drawn: HiddenEffect) -> bool:
    """Whether a seat is taken by what is drawn, or would be much the same thing."""
    effect, axis, location = seat
    if (axis, location) == (drawn.axis, drawn.location):
        return True
    alike = effect == drawn.effect or any({effect, drawn.effect} <= kind for kind in _KINDS)
    return alike and (axis == drawn.axis or None in (axis, drawn.axis))
