"""The effects that a model file states: its own entries, and those that its S3N variant adds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from workbench.core import EffectKey, Estimate, InputError, apart

from .model import VARIANTS, AppliedEffect, Linkage
from .schema import EffectTable

_LINKAGE_KEYS = {"linkage_inertia": ("M11", "M12", "M22"), "linkage_gravity": ("g1", "g2")}
_LINKAGE_UNITS = {"M11": "kg*m^2", "M12": "kg*m^2", "M22": "kg*m^2", "g1": "N*m", "g2": "N*m"}


def effects_of_variant(variant: str, linkage: Linkage | None, file: Path) -> list[AppliedEffect]:
    """Return the effects that a variant of S3N adds to the serial tree."""
    names = VARIANTS[variant]
    if linkage is None and set(names) & set(_LINKAGE_KEYS):
        raise InputError(
            f"variant '{variant}' needs a [linkage] table", file=file, column="variant",
            remedy="give its identified parameters",
        )  # fmt: skip
    return [structural_effect(name, linkage) for name in names]


def structural_effect(name: str, linkage: Linkage | None) -> AppliedEffect:
    """Return a structural effect of S3N with its identified parameters."""
    keys = _LINKAGE_KEYS.get(name, ())
    values = {k: Estimate(getattr(linkage or Linkage(), k), 0.0, _LINKAGE_UNITS[k]) for k in keys}
    return AppliedEffect(EffectKey(name, None), values)


def effects_of_entry(entry: EffectTable, axes: Sequence[str], file: Path) -> list[AppliedEffect]:
    """Return the effect of an entry, or several of a kind."""
    if entry.axis is not None and entry.axis not in axes:
        raise InputError(
            f"effect '{entry.effect}' is on axis '{entry.axis}'", file=file, column="effects.axis",
            remedy=f"axes are {', '.join(axes)}",
        )  # fmt: skip
    try:
        return [AppliedEffect(key, values) for key, values in apart(entry.model_dump())]
    except ValueError as error:
        raise InputError(
            f"effect '{entry.effect}': {error}", file=file, column="effects.parameters",
            remedy="give each parameter one number, or lists of one length",
        ) from error  # fmt: skip
