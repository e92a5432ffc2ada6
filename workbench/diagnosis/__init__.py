"""Which physical effect is missing from a model, and how sure one can be."""

from .diagnose import EXPLAINED, diagnose, improve

__all__ = ["EXPLAINED", "diagnose", "improve"]
