"""Parts that the JSON of several results contains."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from workbench.core import EffectKey, Estimate, Share


def key_dict(key: EffectKey) -> dict[str, Any]:
    """Return an effect and its place."""
    copy = {"copy": key.copy} if key.copy > 1 else {}
    site = {"site": key.site} if key.site else {}
    return {"effect": key.effect, "axis": key.axis, "location": key.location, **copy, **site}


def effect_dict(key: EffectKey, parameters: Mapping[str, Estimate]) -> dict[str, Any]:
    """Return an effect, its place and its parameters."""
    return {**key_dict(key), "parameters": {n: vars(e) for n, e in parameters.items()}}


def key_dicts(keys: Iterable[EffectKey]) -> list[dict[str, Any]]:
    """Return several effects and their places."""
    return [key_dict(k) for k in keys]


def picked(value: object, *names: str) -> dict[str, Any]:
    """Return attributes of a value by name, in this order."""
    return {name: getattr(value, name) for name in names}


def share_dicts(shares: Iterable[Share]) -> list[dict[str, Any]]:
    """Return where the error is."""
    return [picked(s, "axis", "signal", "range", "unit", "share", "quantity") for s in shares]


def clean(value: Any) -> Any:
    """Return the same value in plain Python types, NaN and infinities as None."""
    if isinstance(value, Mapping):
        return {str(k): clean(v) for k, v in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: clean(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, np.ndarray):
        return clean(value.tolist())
    if isinstance(value, (list, tuple)):
        return [clean(v) for v in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return value
