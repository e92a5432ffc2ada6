"""Dry friction with true stiction: at zero slip speed the torque is what holds, up to the static limit.

Karnopp's model with the zero crossings located instead of a band around zero speed (D. Karnopp, Computer
simulation of stick-slip friction in mechanical dynamic systems, J. Dyn. Sys. Meas. Control 107, 1985).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from workbench.core import SimulationError

#: Friction level [N m], never negative, of signed slip speed [rad/s], position [rad] and load [N m].
#: Sticking asks for it at speeds of +-0: the sign is the direction in which the pin would move.
Level = Callable[[float, float, float], float]


@dataclass(frozen=True)
class Friction:
    """Dry friction at one pin or drive.

    Attributes:
        direction: d, slip speed = d . v; the friction torque enters along d. Actuator coordinates, unless
            an integrator has put it into its own.
        level: its magnitude; the value next to zero speed is the static limit in that direction.
        load_axis: the motor whose torque loads the pin, None for neither.
        at_pin: whether it rubs between links rather than in the drive.
    """

    direction: tuple[float, ...]
    level: Level
    load_axis: int | None = None
    at_pin: bool = False


def merged(frictions: Sequence[Friction]) -> tuple[Friction, ...]:
    """Return the frictions of one direction as one with the sum of their levels.

    Raises:
        SimulationError: more than two directions are left.
    """
    by_direction: dict[tuple[float, ...], list[Friction]] = {}
    for friction in frictions:
        by_direction.setdefault(friction.direction, []).append(friction)
    if len(by_direction) > 2:
        raise SimulationError("the rig has stiction at two pins at most; hide fewer dry frictions")
    return tuple(group[0] if len(group) == 1 else _sum(group) for group in by_direction.values())


def _sum(group: list[Friction]) -> Friction:
    levels = [friction.level for friction in group]

    def level(speed: float, position: float, load: float) -> float:
        return sum(each(speed, position, load) for each in levels)

    loads = {friction.load_axis for friction in group} - {None}  # one direction belongs to one motor
    return replace(group[0], level=level, load_axis=loads.pop() if loads else None)
