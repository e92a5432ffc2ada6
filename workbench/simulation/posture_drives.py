"""Drives of a mechanism whose transmission changes, with those effects that its runs have."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError
from workbench.effects import axis_units, effect_named, kinds
from workbench.models import Model

#: Effects at drives that these runs have: the parameter, and its place among the numbers of the drives.
_AT_DRIVES = {
    "reflected_inertia": ("inertia", 0),
    "viscous_damping": ("damping", 1),
    "coulomb_friction": ("torque", 2),
}


def drives_of(model: Model) -> np.ndarray:
    """Return the drives with what effects add (4, n): inertia [kg m^2], damping [N m s/rad], dry friction
    [N m], and the speed at which that is whole [rad/s].

    Raises:
        InputError: an effect that is neither at a drive nor mass of a link, or of another kind.
    """
    creep = [model.sliding_speed * (1.0 if unit == "rad" else 0.1) for unit in axis_units(model)]
    out = np.array([model.actuators.inertia, model.actuators.damping, np.zeros(model.size), creep])
    for effect in model.effects:
        key = effect.key
        if kinds.of_mass(effect_named(key.effect)):
            continue  # in the links of the chain
        if key.effect not in _AT_DRIVES or key.location != "actuator" or key.axis is None:
            raise InputError(
                f"its transmission changes with the posture, and such a model is not simulated with {key}",
                file=model.source, column="effects", remedy="take it out of a copy of the model",
            )  # fmt: skip
        name, row = _AT_DRIVES[key.effect]
        out[row, model.axes.index(key.axis)] += effect.values[name]
    return out


def runs_in_loop(model: Model) -> bool:
    """Return whether these runs have all effects of a model whose transmission changes."""
    try:
        drives_of(model)
    except InputError:
        return False
    return True
