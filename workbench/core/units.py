"""Units at the boundary: anything pint knows comes in, SI is what the code computes with."""

from __future__ import annotations

from functools import lru_cache

import pint

REGISTRY: pint.UnitRegistry = pint.UnitRegistry()

#: Accepted dimensions of each signal kind: the rotary unit first, then the linear one.
KINDS: dict[str, tuple[str, ...]] = {
    "time": ("s",),
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "torque": ("N*m", "N"),
    "current": ("A",),
    "voltage": ("V",),
    "temperature": ("K",),
    "force": ("N",),
}


@lru_cache(maxsize=256)
def to_si(unit: str, kind: str) -> tuple[float, float, str]:
    """Scale and offset that turn a number in `unit` into SI for a signal kind.

    Args:
        unit: any unit pint can parse, e.g. ``"deg"``, ``"mm"``, ``"degC"``.
        kind: one of `KINDS`.

    Returns:
        ``(scale, offset, si_unit)`` with ``si = scale * number + offset``.

    Raises:
        ValueError: unknown unit, or a unit of another dimension; the text says which.
    """
    try:
        parsed = REGISTRY.parse_units(unit)
    except Exception as error:
        raise ValueError(f"unknown unit '{unit}'") from error
    for si in KINDS[kind]:
        target = REGISTRY.parse_units(si)
        # pint holds an angle to be a bare number; an angle unit must still not pass for a length
        if parsed.dimensionality == target.dimensionality:
            zero = REGISTRY.Quantity(0.0, parsed).to(target).magnitude
            one = REGISTRY.Quantity(1.0, parsed).to(target).magnitude
            return float(one - zero), float(zero), si
    expected = " or ".join(KINDS[kind])
    raise ValueError(f"unit '{unit}' is not a unit of {kind} (expected {expected} or alike)")


def torque_unit(position_unit: str) -> str:
    """The unit of torque that goes with a unit of position: N m with rad, N with m."""
    return "N" if position_unit == "m" else "N m"
