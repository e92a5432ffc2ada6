"""The result of checking a model: every compared quantity, and whether it agreed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from .shown import Shown


@dataclass(frozen=True)
class Check:
    """One quantity computed in two or more independent ways.

    Attributes:
        name: what was compared; names the broken quantity when it fails.
        value: largest difference found [unit].
        tolerance: largest difference that counts as agreement [unit].
        unit: of both; empty for a relative difference.
        about: who was held against whom.
        hint: what may be wrong and what to do, where the check failed and the cause shows.
    """

    name: str
    value: float
    tolerance: float
    unit: str = ""
    about: str = ""
    hint: str = ""

    @property
    def passed(self) -> bool:
        """Return whether the difference is within tolerance; a NaN is not."""
        return bool(self.value <= self.tolerance)


@dataclass(frozen=True, repr=False)
class Verification(Shown):
    """A model compared with its own closed chain, in every engine.

    Attributes:
        model: the model's name.
        checks: in the order in which one would look: kinematics first, motion last.
        variants: mass matrix (M11, M12, M22) at alpha = 90 degrees, serial coordinates [kg m^2].
        alpha_deg, radius: spectral radius of the explicit variant's iteration over alpha, both (K,).
        facts: numbers that are stated rather than judged: name -> (value, unit, sentence).
        not_checked: what could not be compared and why.
    """

    model: str
    checks: tuple[Check, ...]
    variants: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    alpha_deg: np.ndarray = field(default_factory=lambda: np.zeros(0))
    radius: np.ndarray = field(default_factory=lambda: np.zeros(0))
    facts: Mapping[str, tuple[float, str, str]] = field(default_factory=dict)
    not_checked: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Return whether every check passed."""
        return all(check.passed for check in self.checks)
