"""Hidden effects of the virtual hardware, compared with the found ones."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from workbench.core import Diagnosis, EffectKey, Estimate, Finding, Improvement, Step

from .json import Truth
from .numbers import Z95, interval, number, unit_text
from .wording import capital, effect_phrase, parameter_name


@dataclass(frozen=True)
class TruthRow:
    """One parameter of one hidden effect: true value, found value, and whether it is inside the interval."""

    effect: str
    outcome: str
    parameter: str
    true: str
    found: str
    inside: str


def truth_rows(result: Improvement | Diagnosis, truth: Truth) -> tuple[TruthRow, ...]:
    """Return one row per hidden parameter; at least one per hidden effect.

    Args:
        result: what was found.
        truth: mappings with ``effect``, ``axis``, ``location`` (the drive if not said) and ``parameters``:
            name to a number, to ``{"value", "unit"}``, or to an `Estimate`. The place is named as a finding
            would name it.
    """
    found = result.kept if isinstance(result, Improvement) else result.findings
    rows: list[TruthRow] = []
    for hidden in truth:
        key = EffectKey(hidden["effect"], hidden.get("axis"), hidden.get("location", "actuator"))
        named, outcome, estimates = _match(key, found)
        title = capital(effect_phrase(named))
        parameters = dict(hidden.get("parameters") or {})
        if not parameters:
            rows.append(TruthRow(title, outcome, "", "", "", ""))
        for name, value in parameters.items():
            rows.append(_row(title, outcome, name, value, estimates.get(name)))
            title = outcome = ""
    return tuple(rows)


def _row(title: str, outcome: str, name: str, value: Any, estimate: Estimate | None) -> TruthRow:
    true, unit = _value(value)
    unit = unit or (estimate.unit if estimate else "")
    true_text = f"{number(true, 4)} {unit_text(unit)}".strip()
    if estimate is None:
        return TruthRow(title, outcome, parameter_name(name), true_text, "", "")
    inside = ""
    if math.isfinite(estimate.std) and estimate.std > 0:
        inside = "yes" if abs(estimate.value - true) <= Z95 * estimate.std else "no"
    return TruthRow(title, outcome, parameter_name(name), true_text, interval(estimate), inside)


def _match(key: EffectKey, found: Iterable[Step | Finding]) -> tuple[EffectKey, str, Mapping[str, Estimate]]:
    """The key as the finding names its place, what came of it, and what was estimated."""
    entries = list(found)
    for entry in entries:
        if entry.key == key:
            return entry.key, "found", entry.parameters
    for entry in entries:
        if key in entry.indistinguishable_from:
            return key, f"named as a look-alike of {effect_phrase(entry.key)}", {}
    return key, "not found", {}


def _value(value: Any) -> tuple[float, str]:
    if isinstance(value, Estimate):
        return value.value, value.unit
    if isinstance(value, Mapping):
        return float(value["value"]), str(value.get("unit", ""))
    return float(value), ""
