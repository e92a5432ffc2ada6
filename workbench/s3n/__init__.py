"""Simulator-Side System Normalization: closed forms, every variant, and the normalised tree as plain MJCF."""

from .drive_map import drive_map
from .dynamics import Dynamics, compiled_dynamics, reduced, variant_dynamics
from .explicit import explicit_spectral_radius
from .floating_base import FloatingBaseError, floating_base_error
from .loop import ConstraintSettings
from .normalise import NormalisedTree, normalise, write_normalised
from .on_drives import off_drives, on_drives
from .posture import PostureDependent
from .posture_chain import PostureChain
from .posture_error import posture_error
from .posture_fitted import fit_native
from .reach import Reach, reach
from .runner import VariantRun, run_variant
from .variants import VARIANT_NAMES, omissions, usual_variant, with_variant

__all__ = [
    "VARIANT_NAMES", "ConstraintSettings", "Dynamics", "FloatingBaseError", "NormalisedTree", "PostureChain",
    "PostureDependent", "Reach", "VariantRun", "compiled_dynamics", "drive_map",
    "explicit_spectral_radius", "fit_native", "floating_base_error", "normalise", "off_drives", "omissions",
    "on_drives", "posture_error", "reach", "reduced", "run_variant", "usual_variant", "variant_dynamics",
    "with_variant", "write_normalised",
]  # fmt: skip
