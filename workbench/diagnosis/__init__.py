"""Diagnosis: which physical effect is missing from a model, and how certain that is."""

from .checks.doubts import doubts
from .diagnose import diagnose
from .fitting.normal_equations import Normal, jackknife, total
from .improve import improve as improve
from .link_equations import LinkEquations, link_equations
from .mend import states_gain, with_mended_gains
from .one_effect import fit_effect

__all__ = [
    "LinkEquations",
    "Normal",
    "diagnose",
    "doubts",
    "fit_effect",
    "improve",
    "jackknife",
    "link_equations",
    "states_gain",
    "total",
    "with_mended_gains",
]
