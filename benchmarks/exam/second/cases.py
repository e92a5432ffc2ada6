"""The second leg's cases: every effect once, some alike on both drives, pairs, triples, none, outsiders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..cases import Case, interleaved
from .leg import Hidden
from .shapes import Draw, Seat, hidden_of
from .sizes import LARGEST, OUTSIDERS, SEATS, SMALLEST

#: Effects that are much the same thing on one axis, or two of which a leg would not be built with.
_KINDS = (
    ("viscous_damping", "quadratic_drag"),
    (
        "coulomb_friction",
        "stribeck_friction",
        "asymmetric_friction",
        "load_dependent_friction",
        "presliding_hysteresis",
    ),
    ("torque_constant_error", "controller_gain_error"),
    ("torque_saturation", "speed_torque_limit"),
    ("current_loop_lag", "velocity_filter_lag", "command_delay", "sensor_delay"),
    ("reflected_inertia", "payload_mass", "parallel_spring", "linkage_inertia", "linkage_gravity"),
    ("torque_bias", "encoder_offset", "encoder_scale", "encoder_eccentricity"),
    ("joint_compliance", "backlash"),
    ("cogging",),
)
_KIND = {effect: number for number, kind in enumerate(_KINDS) for effect in kind}
#: What two drives of one make have in common.
ALIKE = (
    "current_loop_lag",
    "coulomb_friction",
    "torque_constant_error",
    "viscous_damping",
    "reflected_inertia",
    "presliding_hysteresis",
    "joint_compliance",
)
_COUNTS = {"pair": 8, "triple": 6}
#: Nothing hidden: how it is recorded.
_CLEAN = ("usual", "usual", "coarse", "fast_loop", "usual")
_ONE, _MANY, _BOTH = (1.5, 6.0), (2.0, 5.0), (2.0, 12.0)  # sizes over the smallest


def second_cases(seed: int) -> list[Case]:
    """60 cases in an order whose every beginning is a fair sample of kinds."""
    groups = [_singles(seed), _alike(seed), _several(seed, "pair", 2), _several(seed, "triple", 3)]
    groups += [_clean(seed), _outsiders(seed)]
    return interleaved(groups)


def _singles(seed: int) -> list[Case]:
    """Each effect once, at a place that is drawn."""
    generator = np.random.default_rng([seed, 227])
    cases = []
    for effect in generator.permutation(sorted(_KIND)):
        seat = _seat(effect, generator)
        cases.append(_case(seed, "single", [_sized(seat, _ONE, generator)], len(cases)))
    return cases


def _alike(seed: int) -> list[Case]:
    """One effect on both drives with the same parameters, each large enough to show alone."""
    generator = np.random.default_rng([seed, 229])
    cases = []
    for effect in ALIKE:
        hip, knee = (effect, "hip", "actuator"), (effect, "knee", "actuator")
        larger = max(hip, knee, key=lambda seat: SMALLEST[seat])
        first = _sized(larger, _BOTH, generator)
        both = [Hidden(effect, axis, "actuator", first.parameters) for axis in ("hip", "knee")]
        cases.append(_case(seed, "pair", both, 100 + len(cases), "alike"))
    return cases


def _several(seed: int, kind: str, count: int) -> list[Case]:
    generator = np.random.default_rng([seed, 233, count])
    return [
        _case(seed, kind, _together(count, generator), 1000 * count + number)
        for number in range(_COUNTS[kind])
    ]


def _together(count: int, generator: np.random.Generator) -> list[Hidden]:
    """Effects of different places and kinds, every effect as likely as any other."""
    chosen: list[Seat] = []
    while len(chosen) < count:
        effect = generator.choice(sorted(_KIND))
        seat = _seat(effect, generator)
        if not any(_clash(seat, other) for other in chosen):
            chosen.append(seat)
    return [_sized(seat, _MANY, generator) for seat in chosen]


def _clash(one: Seat, other: Seat) -> bool:
    if one[1:] == other[1:] or one[0] == other[0]:
        return True
    return _KIND[one[0]] == _KIND[other[0]] and (one[1] == other[1] or None in (one[1], other[1]))


def _clean(seed: int) -> list[Case]:
    return [_case(seed, "clean", [], 300 + i, recorded=way) for i, way in enumerate(_CLEAN)]


def _outsiders(seed: int) -> list[Case]:
    generator = np.random.default_rng([seed, 239])
    cases = []
    for effect in generator.permutation(sorted(OUTSIDERS)):
        seat = _seat(effect, generator)
        cases.append(_case(seed, "outsider", [_sized(seat, _MANY, generator)], 400 + len(cases)))
    return cases


def _seat(effect: str, generator: np.random.Generator) -> Seat:
    """One of the places where an effect is hidden."""
    seats = [seat for seat in SEATS if seat[0] == effect]
    return seats[generator.integers(len(seats))]


def _sized(seat: Seat, times: tuple[float, float], generator: np.random.Generator) -> Hidden:
    smallest = SMALLEST[seat]
    low, high = (f * smallest for f in times)
    high = max(min(high, LARGEST.get(seat[0], high)), low)
    size = float(np.exp(generator.uniform(np.log(low), np.log(high))))
    return hidden_of(seat, size, Draw(generator))


def _place(hidden: Hidden) -> str:
    at_pin = "joint" if hidden.location == "joint" else None
    return "-".join(p for p in (hidden.effect, hidden.axis, at_pin) if p)


def _case(
    seed: int, kind: str, hidden: Sequence[Hidden], number: int, word: str = "", recorded: str = "usual"
) -> Case:
    what = "+".join(map(_place, hidden)) if hidden else f"{number}-{recorded}"
    return Case(
        "-".join(part for part in (f"second-s{seed}", kind, word, what) if part),
        kind,
        100_000 * seed + number,
        tuple(hidden),
        "drawn" if hidden else "none",
        recorded,
        "second",
    )
