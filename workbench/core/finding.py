"""What a diagnosis names: an effect in a place, its parameters with deviations, and how sure it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from .shown import Shown


@dataclass(frozen=True)
class Estimate:
    """A number with its standard deviation and unit."""

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class EffectKey:
    """The name of an effect, the axis it acts on (None: all axes), and whether at its drive or its joint.

    `copy`: which one of several in one place, as harmonics of a ripple are. `site`: the MJCF site that it
    hangs on, for the reader; two keys are equal whatever it is. None where there is none or it is not known.
    """

    effect: str
    axis: str | None
    location: Literal["actuator", "joint"] = "actuator"
    copy: int = 1
    site: str | None = field(default=None, compare=False)

    def __str__(self) -> str:
        place = f"{self.effect}@{self.axis}" if self.axis else self.effect
        place = place if self.location == "actuator" else f"{place}({self.location})"
        return place if self.copy == 1 else f"{place}#{self.copy}"

    def same_place(self, other: EffectKey) -> bool:
        """Return whether it is the same effect in the same place, possibly another copy of it."""
        there = self.effect, self.axis, self.location
        return there == (other.effect, other.axis, other.location)


@dataclass(frozen=True, repr=False)
class Finding(Shown):
    """One effect that explains the data.

    Attributes:
        key: which effect, where.
        parameters: name -> estimate.
        error_after: `Comparison.error` with this effect (and the findings before it) in the model.
        holdout_error_before, holdout_error_after: the same on data not used for the fit; None where
            there is none.
        probability: calibrated chance that the name is right.
        indistinguishable_from: what explains the same data as well.
        evidence: one line each.
        number: which number of the model this corrects, in words; empty where an effect was missing.
        model_value: what the model had of that number, None where it states none.
        total: what that number is with the finding.
    """

    key: EffectKey
    parameters: Mapping[str, Estimate]
    error_after: float
    holdout_error_before: float | None
    holdout_error_after: float | None
    probability: float
    indistinguishable_from: tuple[EffectKey, ...] = ()
    evidence: tuple[str, ...] = ()
    number: str = ""
    model_value: float | None = None
    total: Estimate | None = None

    @property
    def is_doubtful(self) -> bool:
        """Return whether other causes are likelier, together, than the one that is named."""
        return self.probability < 0.5
