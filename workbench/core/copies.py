"""Several effects of a kind in one place, such as harmonics: one row in files, lists of numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .finding import EffectKey, Estimate

_PLACE = ("effect", "axis", "location")


def together(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return rows of effects, those of a kind in one place merged: ``{"value": [...], "std": [...]}``.

    Args:
        rows: mappings with ``effect``, ``axis`` and ``location`` (either may be missing), ``parameters``: a
            name to ``{"value", "std", "unit"}``, ``copy`` where it is not the first of its kind, and more,
            which is taken from the first.
    """
    groups: list[list[Mapping[str, Any]]] = []
    for row in rows:
        place = [row.get(k) for k in _PLACE]
        kin = [g for g in groups if [g[0].get(k) for k in _PLACE] == place]
        if kin and row.get("copy", 1) > 1:
            kin[-1].append(row)
        else:
            groups.append([row])
    out = []
    for same in groups:
        parameters = same[0]["parameters"]
        if len(same) > 1 and parameters:
            each = [row["parameters"] for row in same]
            parameters = {
                name: {k: [p[name][k] for p in each] for k in ("value", "std")} | {"unit": own["unit"]}
                for name, own in parameters.items()
            }
        out.append({k: v for k, v in same[0].items() if k != "copy"} | {"parameters": parameters})
    return out


def apart(row: Mapping[str, Any]) -> list[tuple[EffectKey, dict[str, Estimate]]]:
    """Return the effects of a row: one, or one for each number of its lists, in their order.

    Raises:
        ValueError: lists of different lengths, or a list beside a plain number.
    """
    parameters = {name: _listed(p) for name, p in row["parameters"].items()}
    lengths = {len(values) for values, _, _ in parameters.values()}
    if len(lengths) > 1:
        raise ValueError(f"{', '.join(parameters)} need the same number of values")
    location = row.get("location") or "actuator"
    return [
        (
            EffectKey(row["effect"], row.get("axis"), location, k + 1),
            {name: Estimate(v[k], std[k], unit) for name, (v, std, unit) in parameters.items()},
        )
        for k in range(lengths.pop() if lengths else 1)
    ]


def _listed(parameter: Any) -> tuple[list[float], list[float], str]:
    """Return values, deviations (null or JSON infinity where the data leave one open) and unit."""
    if not isinstance(parameter, Mapping):
        parameter = {"value": parameter}
    value, std = parameter["value"], parameter.get("std", 0.0)
    values = list(value) if isinstance(value, (list, tuple)) else [value]
    values = [float("nan") if v is None else float(v) for v in values]
    stds = list(std) if isinstance(std, (list, tuple)) else [std] * len(values)
    if len(stds) != len(values) or not values:
        raise ValueError("value and std need the same number of values")
    return values, [float("inf") if s is None else float(s) for s in stds], parameter.get("unit", "")
