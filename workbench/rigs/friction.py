"""Dry friction with true sticking: at zero slip speed the torque is whatever holds, up to the static limit.

Karnopp's model with the zero crossings located instead of a band around zero speed (D. Karnopp, Computer
simulation of stick-slip friction in mechanical dynamic systems, J. Dyn. Sys. Meas. Control 107, 1985).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

#: Friction level [N m], never negative, of signed slip speed [rad/s], position [rad] and load [N m].
#: Sticking asks for it at speeds of +-0: the sign is the direction in which the pin would move.
Level = Callable[[float, float, float], float]


@dataclass(frozen=True)
class Friction:
    """Dry friction at one pin or drive.

    Attributes:
        direction: d, slip speed = d . v in actuator coordinates; the friction torque enters along d.
        level: its magnitude; the value next to zero speed is the static limit in that direction.
        load_axis: the motor whose torque loads the pin, None for neither.
    """

    direction: tuple[float, float]
    level: Level
    load_axis: int | None = None


def merged(frictions: list[Friction]) -> tuple[Friction, ...]:
    """Frictions at the same pin as one, whose level is their sum."""
    by_direction: dict[tuple[tuple[float, float], int | None], list[Friction]] = {}
    for friction in frictions:
        by_direction.setdefault((friction.direction, friction.load_axis), []).append(friction)
    return tuple(
        group[0] if len(group) == 1 else Friction(direction, _sum([f.level for f in group]), load_axis)
        for (direction, load_axis), group in by_direction.items()
    )


def _sum(levels: list[Level]) -> Level:
    def level(speed: float, position: float, load: float) -> float:
        return sum(each(speed, position, load) for each in levels)

    return level
