"""Where an effect acts on the leg, and a smooth torque there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Direction = tuple[float, float]

#: Torque [N m] of position [rad] and speed [rad/s] at one place.
Law = Callable[[float, float], float]


@dataclass(frozen=True)
class Place:
    """Where an effect acts.

    Attributes:
        index: of the motor.
        direction: d; position there is d . q, and a torque there enters as d times it, in actuator
            coordinates.
        at_pin: on the links rather than in the drive, which are two things once the drive is not rigid.
    """

    index: int
    direction: Direction
    at_pin: bool = False


@dataclass(frozen=True)
class Passive:
    """A smooth torque at a place.

    Attributes:
        at: where it acts.
        law: of position and speed there.
        feels: the direction whose position and speed it is of, where that is not the place's own.
    """

    at: Place
    law: Law
    feels: Direction | None = None
