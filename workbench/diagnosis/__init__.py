"""Diagnosis: which physical effect is missing from a model, and how certain that is."""

from .checks.doubts import doubts
from .diagnose import diagnose
from .improve import improve as improve
from .mend import with_mended_gains
from .one_effect import fit_effect

__all__ = ["diagnose", "doubts", "fit_effect", "improve", "with_mended_gains"]
