"""Effects, places and values as written on the command line."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from typing import Any

from workbench.core import EffectKey, Estimate, InputError


def parse_place(text: str) -> EffectKey:
    """Return the key of ``effect``, ``effect@axis`` or ``effect@axis(joint)``."""
    name, _, axis = text.partition("@")
    if axis.endswith("(joint)"):
        return EffectKey(name, axis[: -len("(joint)")], "joint")
    return EffectKey(name, axis or None)


def with_values(found: list[Any], values: dict[str, list[float]]) -> list[Any]:
    """Return an effect, or several of a kind in one place, with given values in place of its own.

    Raises:
        InputError: not as many values as there are of a kind.
    """
    from workbench.models import AppliedEffect

    count = max(len(v) for v in values.values())
    if len(found) == 1 and not found[0].parameters:
        found = [AppliedEffect(replace(found[0].key, copy=k + 1)) for k in range(count)]
    for name, numbers in values.items():
        if len(numbers) != len(found):
            raise InputError(
                f"{name}: values given {len(numbers)}, wanted {len(found)}",
                remedy="give each parameter the same number of values, separated by commas: torque=0.8,0.2 "
                "order=7,28",
            )
    return [
        AppliedEffect(a.key, {**a.parameters, **{n: Estimate(v[k], 0.0, "") for n, v in values.items()}})
        for k, a in enumerate(found)
    ]


def parse_lists(texts: list[str]) -> dict[str, list[float]]:
    """Return numbers by name from ``name=value`` or ``name=value,value`` words.

    Raises:
        InputError: not of that form, not a finite number, or a name that stands twice.
    """
    out: dict[str, list[float]] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            numbers = [float(each) for each in value.split(",")]
        except ValueError:
            numbers = [float("nan")]
        if not equals or not all(map(isfinite, numbers)):
            raise InputError(f"'{text}' is not name=value with a number", remedy="e.g. torque=0.25")
        if name in out:
            raise InputError(f"{name} is given twice", remedy=f"give it once, e.g. {text}")
        out[name] = numbers
    return out


def parse_values(texts: list[str]) -> dict[str, Estimate]:
    """Return one number by name from ``name=value`` words.

    Raises:
        InputError: as `parse_lists`, or more numbers than one.
    """
    found = parse_lists(texts)
    for text, numbers in zip(texts, found.values(), strict=True):
        if len(numbers) > 1:
            raise InputError(f"'{text}' is not name=value with a number", remedy="e.g. torque=0.25")
    return {name: Estimate(number, 0.0, "") for name, (number,) in found.items()}
