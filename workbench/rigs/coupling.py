"""Elements between a motor and its link, and between the stand of the leg and the ground."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Coupling:
    """A spring in series: torque = stiffness dead(wind) + damping wind'.

    The wind is the angle by which the motor's side leads; dead() takes half the gap off either side of it
    and is zero within, as is the damping of a gap.

    Attributes:
        stiffness: [N m/rad].
        damping: [N m s/rad], of a gap only while a flank touches.
        gap: whole play, from one flank to the other [rad].
    """

    stiffness: float
    damping: float = 0.0
    gap: float = 0.0


@dataclass(frozen=True)
class Base:
    """A compliant stand along x: mass x'' + damping x' + stiffness x = force of the leg on it.

    Attributes:
        stiffness: [N/m].
        damping: [N s/m].
        mass: of the stand alone [kg]; the leg's mass rides on it.
    """

    stiffness: float
    damping: float
    mass: float
