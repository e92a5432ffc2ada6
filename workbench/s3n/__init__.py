"""Simulator-Side System Normalization: closed forms, every variant, and the normalised tree as plain MJCF."""

from .dynamics import Dynamics, compiled_dynamics, reduced, variant_dynamics
from .explicit import explicit_spectral_radius
from .loop import ConstraintSettings
from .runner import VariantRun, cost_per_step, run_variant
from .variants import VARIANT_NAMES, with_variant

__all__ = [
    "VARIANT_NAMES",
    "ConstraintSettings",
    "Dynamics",
    "VariantRun",
    "compiled_dynamics",
    "cost_per_step",
    "explicit_spectral_radius",
    "reduced",
    "run_variant",
    "variant_dynamics",
    "with_variant",
]
