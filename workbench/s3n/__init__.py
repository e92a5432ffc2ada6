"""Simulator-Side System Normalization: closed forms, every variant, and the normalised tree as plain MJCF."""

from .dynamics import Dynamics, compiled_dynamics, reduced, variant_dynamics
from .explicit import explicit_spectral_radius
from .floating_base import FloatingBaseError, floating_base_error
from .loop import ConstraintSettings
from .normalise import NormalisedTree, normalise, write_normalised
from .runner import VariantRun, cost_per_step, run_variant
from .variants import VARIANT_NAMES, with_variant

__all__ = [
    "VARIANT_NAMES",
    "ConstraintSettings",
    "Dynamics",
    "FloatingBaseError",
    "NormalisedTree",
    "VariantRun",
    "compiled_dynamics",
    "cost_per_step",
    "explicit_spectral_radius",
    "floating_base_error",
    "normalise",
    "reduced",
    "run_variant",
    "variant_dynamics",
    "with_variant",
    "write_normalised",
]
