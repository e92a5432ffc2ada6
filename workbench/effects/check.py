"""A model's effects checked against the catalogue: names, places, parameters, physical bounds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.core import Estimate, InputError
from workbench.core.files import as_path
from workbench.core.units import is_unit
from workbench.models import MOST, AppliedEffect, Model, Placement, read_model

from .base import is_rotary
from .catalogue import effect_named


def load_model(path: str | Path | Model) -> Model:
    """Return a model whose effects were checked against the catalogue.

    Args:
        path: its file, or the name of a shipped model or packaged robot; a model is returned as it is.

    Raises:
        InputError: anything wrong with the file or its effects, in one line.
    """
    if isinstance(path, Model):
        return path
    model = read_model(as_path(path, "a model"))
    checked = replace(model, effects=())
    for applied in model.effects:
        checked = checked.with_effect(check_effect(checked, applied))
    return checked


def check_effect(model: Model, applied: AppliedEffect) -> AppliedEffect:
    """Return one effect with its units filled in.

    Raises:
        InputError: wrong place, unknown or missing parameter, value outside its physical bounds.
    """
    effect, key = effect_named(applied.key.effect, model.source), applied.key

    def refuse(problem: str, remedy: str = "") -> InputError:
        return InputError(problem, file=model.source, remedy=remedy)

    if effect.locations and key.axis not in model.driven:
        choices = ", ".join(f"{effect.name}@{axis}" for axis in model.driven)
        raise refuse(f"{effect.name} acts on one axis, not on '{key.axis or 'all'}'", f"say which: {choices}")
    if not effect.locations and key.axis is not None:
        raise refuse(f"{effect.name} acts on all axes at once", f"leave '@{key.axis}' out")
    seats = effect.locations or ("actuator",)
    if key.location not in seats:
        raise refuse(f"{effect.name} cannot be at the {key.location}", f"its place is the {seats[0]}")
    if key.copy > 1 and effect.search.repeats is None:
        raise refuse(f"{effect.name} has one value of each parameter", "give one number, not a list")
    if not effect.applies(model, key):
        raise refuse(
            f"{effect.name} does not apply to model '{model.name}'", f"it needs {effect.words.needs}"
        )
    known = {p.name: p for p in effect.parameters}
    for name in applied.parameters:
        if name not in known:
            raise refuse(f"{effect.name} has no parameter '{name}'", f"it has {', '.join(known) or 'none'}")
    place, checked = Placement.of(model, key), {}
    for name, parameter in known.items():
        unit = parameter.unit if key.axis is None else parameter.unit_on(axis_unit(model, key.axis))
        in_unit = "" if unit == "1" else f" {unit}"
        if name not in applied.parameters and parameter.optional:
            continue
        if name not in applied.parameters:
            given_in = f" in{in_unit}" if in_unit else ""
            raise refuse(f"{effect.name} needs the parameter '{name}'", f"give {name}=VALUE{given_in}")
        estimate = applied.parameters[name]
        if estimate.unit and not is_unit(estimate.unit, unit):
            raise refuse(f"{effect.name}: {name} is in '{estimate.unit}'", f"give it in {unit}")
        lower, _ = parameter.bounds(model, place)  # negative where a number of the model may be less
        lower, upper = max(lower, -MOST), min(parameter.upper, MOST)  # what can be written can be read
        if not (np.isfinite(estimate.value) and lower <= estimate.value <= upper):
            allowed = f"{lower:g} to {upper:g}{in_unit}"
            raise refuse(
                f"{effect.name}: {name} = {estimate.value:g} lies outside {allowed}",
                "give a value that a body can physically have",
            )
        checked[name] = Estimate(estimate.value, estimate.std, unit)
    coefficients, shape = effect.parameters.to_coefficients({name: e.value for name, e in checked.items()})
    low, high = effect.parameters.bounds(model, place, shape)
    slack = 1e-9 * np.maximum(1.0, np.abs(coefficients))
    if np.any(coefficients < low - slack) or np.any(coefficients > high + slack):
        given = ", ".join(f"{name} = {e.value:g}" for name, e in checked.items())
        limits = ", ".join(f"{a:g} to {b:g}" for a, b in zip(low, high, strict=True))
        raise refuse(f"{effect.name}: {given} is impossible for a body", f"limits are {limits}")
    return AppliedEffect(key, checked)


def axis_unit(model: Model, axis: str) -> str:
    """Return ``rad`` or ``m``: the unit of an axis's position."""
    return axis_units(model)[model.axes.index(axis)]


def axis_units(model: Model) -> tuple[str, ...]:
    """Return ``rad`` or ``m`` per axis, by the joint that its drive moves first."""
    return tuple("rad" if is_rotary(model, axis) else "m" for axis in model.axes)
