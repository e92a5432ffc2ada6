"""Which physical effect is missing from a model, and how sure one can be."""

from .diagnose import EXPLAINED, diagnose, improve
from .one_effect import fit_effect

__all__ = ["EXPLAINED", "diagnose", "fit_effect", "improve"]
