"""The error of every step and the noise floor: the steps, and a log axis to draw them on."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from workbench.core import Comparison, Diagnosis, EffectKey, Result

from .wording import capital, effect_phrase

GIVEN = "Model as given"


@dataclass(frozen=True)
class Rung:
    """The errors with all effects up to `label` in the model; `holdout` is None without held-out data."""

    label: str
    error: float
    holdout: float | None = None


@dataclass(frozen=True)
class LogAxis:
    """A logarithmic axis from `low` to `high` with labelled `ticks`."""

    low: float
    high: float
    ticks: tuple[float, ...]

    def place(self, value: float | None) -> float | None:
        """Return the place of `value`: 0 at `low`, 1 at `high`; None without a value."""
        if value is None or not (math.isfinite(value) and value > 0):
            return None
        return math.log(value / self.low) / math.log(self.high / self.low)


def rungs(result: Result) -> tuple[Rung, ...]:
    """Return the model as given, then each effect added to those above it."""
    if isinstance(result, Comparison):
        return (Rung(GIVEN, result.error),)
    if isinstance(result, Diagnosis):
        held = next((f.holdout_error_before for f in result.findings), None)
        first = Rung(GIVEN, result.error, held)
        return (first, *(Rung(_plus(f.key), f.error_after, f.holdout_error_after) for f in result.findings))
    first = Rung(GIVEN, result.error_before, result.holdout_error_before)
    return (first, *(Rung(_plus(s.key), s.error, s.holdout_error) for s in result.steps))


def log_axis(values: Iterable[float | None]) -> LogAxis:
    """Return an axis with margins on both sides of `values`, and ticks at 1, 2 and 5 of each decade."""
    good = [v for v in values if v is not None and math.isfinite(v) and v > 0] or [1.0]
    low, high = min(good) / 1.35, max(good) * 1.35
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = (1, 2, 5) if len(decades) <= 4 else (1,)
    ticks = tuple(m * 10.0**d for d in decades for m in steps if low <= m * 10.0**d <= high)
    return LogAxis(low, high, ticks)


def _plus(key: EffectKey) -> str:
    return f"+ {capital(effect_phrase(key))}"
