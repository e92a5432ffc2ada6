"""The parallelogram's inertia and gravity from its bodies: masses, lengths, central inertias.

Every body's centre lies at a e(q1) + c e(q2), with e(q) the direction of a link at the angle q, and turns
with the thigh or with the shank. So the kinetic energy is

    M11 w1^2 / 2 + M22 w2^2 / 2 + M12 cos(q2 - q1) w1 w2

with M11 = sum m a^2 + I of what turns with the thigh, M22 = sum m c^2 + I of what turns with the shank and
M12 = sum m a c; the potential energy is -g1 cos q1 - g2 cos q2 with g1 = g sum m a, g2 = g sum m c.
"""

from __future__ import annotations

from typing import NamedTuple

GRAVITY = 9.81  # m/s^2
THIGH, SHANK, CRANK = 0.175, 0.24, 0.06  # lengths [m]


class Body(NamedTuple):
    """One rigid body: mass [kg], centre a along the thigh and c along the shank [m], inertia [kg m^2]."""

    mass: float
    a: float
    c: float
    inertia: float
    turns_with: int


#: The closed chain of the reference leg.
BODIES = (
    Body(1.8, 0.08, 0.0, 0.012655833, 0),  # thigh
    Body(0.23, THIGH, 0.141006211, 0.002381967, 1),  # shank
    Body(0.05, 0.0, -0.03, 0.0003, 1),  # crank, which points away from the shank
    Body(0.05, 0.0875, -CRANK, 0.000127604, 0),  # coupler, on the crank's end
)


class Structure(NamedTuple):
    """What the energies need: inertias [kg m^2] and gravity torques [N m] in the motors' coordinates."""

    m11: float
    m12: float
    m22: float
    g1: float
    g2: float


def structure(payload: float = 0.0) -> Structure:
    """Links without rotors; `payload` [kg] is a point on the foot."""
    bodies = (*BODIES, Body(payload, THIGH, SHANK, 0.0, 1))
    return Structure(
        sum(b.mass * b.a**2 + b.inertia * (b.turns_with == 0) for b in bodies),
        sum(b.mass * b.a * b.c for b in bodies),
        sum(b.mass * b.c**2 + b.inertia * (b.turns_with == 1) for b in bodies),
        GRAVITY * sum(b.mass * b.a for b in bodies),
        GRAVITY * sum(b.mass * b.c for b in bodies),
    )
