"""Inspection: what recordings show without any model (swaps, signs, units, gains, clocks, limits)."""

from .inspect import inspect
from .result import Inspection, Remark, inspection_dict

__all__ = ["Inspection", "Remark", "inspect", "inspection_dict"]
