"""Units of files: any unit that pint knows is accepted, and the code computes in SI."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import TYPE_CHECKING

from .text import plain

if TYPE_CHECKING:
    import pint

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

_LARGEST = 1e12
_LONGEST = 60  # characters; pint takes a minute for 100,000
# pint works out powers of numbers, however large: only those of names go to it
_TIMES = re.compile(r"\s*(-?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+))\s*\*\s*(?=\D)")
_POWER = re.compile(r"\*\*|\^|[⁰¹²³⁴⁵⁶⁷⁸⁹]")
_POWER_OF_NAME = re.compile(r"(?<=[^\W\d])\s*(?:(?:\*\*|\^)\s*\(?[-+]?\d\)?(?!\d)|⁻?[¹²³⁴])")


@cache
def _registry() -> pint.UnitRegistry:
    """All units that pint knows; loading takes a tenth of a second or more, which recordings in SI avoid."""
    import pint

    return pint.UnitRegistry()


@lru_cache(maxsize=256)
def to_si(unit: str, kind: str) -> tuple[float, float, str]:
    """Return scale and offset that convert a number in `unit` to SI for a signal kind.

    Args:
        unit: any unit pint can parse, e.g. ``"deg"``, ``"mm"``, ``"degC"``; a number of it as
            ``"0.1*deg"``, which of all but time may be negative: what is counted the other way.
        kind: one of `KINDS`.

    Returns:
        ``(scale, offset, si_unit)`` with ``si = scale * number + offset``.

    Raises:
        ValueError: unknown unit, or a unit of another dimension; the text says which.
    """
    if (product := unit.replace(" ", "*")) in KINDS[kind]:
        return 1.0, 0.0, product
    least = 0.0 if kind == "time" else -_LARGEST
    if (times := _TIMES.match(unit)) and least <= (number := float(times[1])) <= _LARGEST and number:
        scale, offset, si = to_si(unit[times.end() :], kind)
        return number * scale, offset, si
    if len(unit) > _LONGEST or _POWER.search(_POWER_OF_NAME.sub("", unit)):
        raise ValueError(f"unknown unit '{unit[:_LONGEST]}'")
    registry = _registry()
    try:
        parsed = registry.parse_units(unit)
        root = registry.get_root_units(parsed)[1]
    except Exception as error:
        raise ValueError(f"unknown unit '{unit}'") from error
    for si in KINDS[kind]:
        target = registry.parse_units(si)
        # pint holds an angle to be a bare number; in root units it is none, nor is its square one
        if root == registry.get_root_units(target)[1]:
            zero = registry.Quantity(0.0, parsed).to(target).magnitude
            one = registry.Quantity(1.0, parsed).to(target).magnitude
            return float(one - zero), float(zero), si
    expected = " or ".join(KINDS[kind])
    raise ValueError(f"unit '{unit}' is not a unit of {kind} (expected {expected} or similar)")


@lru_cache(maxsize=256)
def is_unit(unit: str, wanted: str) -> bool:
    """Return whether `unit` is the `wanted` one in other words: ``"N m s/rad"`` is ``"N*m/(rad/s)"``."""
    if unit_text(unit) == unit_text(wanted):
        return True
    if len(unit) > _LONGEST or _POWER.search(_POWER_OF_NAME.sub("", unit)):
        return False
    registry = _registry()
    try:
        size = registry.Quantity(1.0, registry.parse_units(unit_text(unit).replace(" ", "*")))
        return bool(abs(size.to(registry.parse_units(wanted)).magnitude - 1.0) < 1e-9)
    except Exception:  # whatever pint says of words that are no unit
        return False


def torque_unit(position_unit: str) -> str:
    """Return the torque unit for a position unit: N m with rad, N with m."""
    return "N" if position_unit == "m" else "N m"


def unit_text(unit: str) -> str:
    """Return a unit as printed: ``"N*m/(rad/s)"`` becomes ``"N m/(rad/s)"``; dimensionless is empty."""
    text = plain(unit).replace("**2", "²").replace("**3", "³").replace("^2", "²").replace("^3", "³")
    text = text.replace("*", " ").replace("·", " ")
    return "" if text.strip() in ("1", "-", "dimensionless") else text.strip()
