"""The time within a step at which something changes its sign."""

from __future__ import annotations

from collections.abc import Callable

from .along import Along, Vector

State = tuple[Vector, Vector]  # coordinates and speeds, both (n,)
Switch = Callable[[State], float]  # a quantity whose change of sign ends a smooth piece
TIGHT = 1e-10  # how near zero a quantity counts as there [rad or rad/s]


def crossing(value: Callable[[float], float], low_value: float, high_value: float, h: float) -> float:
    """Return the time at which `value` changes its sign, by regula falsi (Illinois) [s].

    Args:
        value: the quantity at the end of a step of the given length [s].
        low_value, high_value: of no step and of the whole one; their signs differ.
        h: the whole step [s].
    """
    low, high, kept = 0.0, h, 0
    for _ in range(12):
        part = low - low_value * (high - low) / (high_value - low_value)
        if not low < part < high:
            break
        there = value(part)
        if abs(there) < 0.1 * TIGHT:
            return part
        if (there > 0.0) == (low_value > 0.0):
            low, low_value = part, there
            high_value = 0.5 * high_value if kept == 1 else high_value
            kept = 1
        else:
            high, high_value = part, there
            low_value = 0.5 * low_value if kept == -1 else low_value
            kept = -1
    return 0.5 * (low + high)


def slip(along: Along) -> Switch:
    """Return the speed along a direction."""
    return lambda state: along.read(state[1])


def flank(front: int, back: int, wind: float) -> Switch:
    """Return by how much the difference of two coordinates exceeds an angle."""
    return lambda state: state[0][front] - state[0][back] - wind
