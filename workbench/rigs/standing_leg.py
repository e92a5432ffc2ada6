"""The leg with its foot on a force plate: a penalty contact beside the closed form, in small steps.

The plate pushes a foot that is in it with a spring and a damper and never pulls. Along the plate a stiff
spring holds the foot where it last stood, up to Coulomb's limit; there the foot slips and takes its anchor
along (an elastic-plastic contact, as in P. Dupont et al., "Single state elastoplastic friction models",
IEEE Transactions on Automatic Control 47(5), 2002).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, atan2, copysign, cos, sin
from typing import TYPE_CHECKING

from .events import State

if TYPE_CHECKING:
    from .integrate import Integrator

THIGH, SHANK = 0.175, 0.24  # m, as in the reference leg's closed chain
_STEP = 1e-4  # s
_HOLD_STIFFNESS, _HOLD_DAMPING = 5e5, 1000.0  # N/m, N s/m: along the plate, a foot that does not slip


@dataclass
class Plate:
    """A level force plate under the leg.

    Attributes:
        height: of its surface over the hip [m].
        radius: of the foot, a ball about the shank's end [m].
        stiffness, damping: of what gives way under the foot [N/m, N s/m].
        friction: coefficient.
        noise: standard deviation of each force a row [N].
    """

    height: float = -0.34
    radius: float = 0.02
    stiffness: float = 1e5
    damping: float = 150.0
    friction: float = 0.8
    noise: float = 0.25


class Contact:
    """The foot of one run on its plate.

    Args:
        plate: what it stands on.
        shank: length of the shank [m]; `thigh`: of the thigh.
    """

    def __init__(self, plate: Plate, thigh: float = THIGH, shank: float = SHANK) -> None:
        self._plate, self._thigh, self._shank = plate, thigh, shank
        self._anchor: float | None = None

    def force(self, q1: float, q2: float, v1: float, v2: float) -> tuple[float, float]:
        """Return the force of the plate on the foot, along it and up [N]."""
        x, z, dx, dz = self._foot(q1, q2, v1, v2)
        plate = self._plate
        depth = plate.height + plate.radius - z
        if depth <= 0.0:
            return 0.0, 0.0
        up = max(0.0, plate.stiffness * depth - plate.damping * dz)
        anchor = x if self._anchor is None else self._anchor
        held = -_HOLD_STIFFNESS * (x - anchor) - _HOLD_DAMPING * dx
        most = plate.friction * up
        return (held if abs(held) < most else copysign(most, held)), up

    def torque(self, q1: float, q2: float, v1: float, v2: float) -> tuple[float, float]:
        """Return this force's torque on the motors [N m]; it acts halfway, as foot and plate yield alike."""
        along, up = self.force(q1, q2, v1, v2)
        plate = self._plate
        depth = plate.height + plate.radius + self._thigh * cos(q1) + self._shank * cos(q2)
        arm = plate.radius - 0.5 * max(depth, 0.0)
        return (
            self._thigh * (cos(q1) * along + sin(q1) * up),
            self._shank * (cos(q2) * along + sin(q2) * up) + arm * along,
        )

    def settle(self, q1: float, q2: float, v1: float, v2: float) -> None:
        """Move the anchor with a foot that slips, and release it in the air."""
        x, z, dx, _ = self._foot(q1, q2, v1, v2)
        plate = self._plate
        if plate.height + plate.radius - z <= 0.0:
            self._anchor = None
            return
        if self._anchor is None:
            self._anchor = x
        _, up = self.force(q1, q2, v1, v2)
        stretch = -_HOLD_DAMPING * dx - _HOLD_STIFFNESS * (x - self._anchor)
        most = plate.friction * up
        if abs(stretch) > most:
            self._anchor = x + (copysign(most, stretch) + _HOLD_DAMPING * dx) / _HOLD_STIFFNESS

    def _foot(self, q1: float, q2: float, v1: float, v2: float) -> tuple[float, float, float, float]:
        """Forward, where the ball touches (it rolls), and up, its centre; and their rates [m, m/s]."""
        l1, l2, radius = self._thigh, self._shank, self._plate.radius
        return (
            l1 * sin(q1) + l2 * sin(q2) + radius * q2,
            -l1 * cos(q1) - l2 * cos(q2),
            l1 * cos(q1) * v1 + (l2 * cos(q2) + radius) * v2,
            l1 * sin(q1) * v1 + l2 * sin(q2) * v2,
        )


class StandingLeg:
    """A `MovingLeg` on a plate.

    Args:
        contact: of its foot.
        leg: of rigid parts, pushed by the contact's torque.
    """

    def __init__(self, contact: Contact, leg: Integrator) -> None:
        self._contact, self._leg = contact, leg

    def start(self, q1: float, q2: float) -> State:
        """Return the state at rest with the motors at `q1`, `q2` [rad]."""
        state = self._leg.start(q1, q2)
        self._contact.settle(*self._leg.motors(state))
        return state

    def motors(self, state: State) -> tuple[float, float, float, float]:
        """Return angles [rad] and speeds [rad/s] of both motors."""
        return self._leg.motors(state)

    def advance(self, state: State, u1: float, u2: float, duration: float) -> State:
        """Return the state after `duration` [s] under motor torques `u1`, `u2` [N m]."""
        steps = max(1, int(duration / _STEP + 0.999999))
        for _ in range(steps):
            state = self._leg.advance(state, u1, u2, duration / steps)
            self._contact.settle(*self._leg.motors(state))
        return state

    def ground_force(self, state: State) -> tuple[float, float, float]:
        """Return the force of the plate on the foot [N]: forward, sideways, up."""
        along, up = self._contact.force(*self._leg.motors(state))
        return along, 0.0, up


def reach(x: float, z: float) -> tuple[float, float]:
    """Return joint angles (hip, knee) [rad] that bring the centre of the foot to `x`, `z` [m]."""
    alpha = acos((x * x + z * z - THIGH**2 - SHANK**2) / (2 * THIGH * SHANK))
    swing = atan2(x, -z)
    return swing - atan2(SHANK * sin(alpha), THIGH + SHANK * cos(alpha)), alpha
