"""What recordings say about themselves, before any model: swaps, signs, units, gains, clocks, limits."""

from .inspect import inspect
from .result import Excited, Inspection, RecordingInspection, Remark, inspection_dict

__all__ = ["Excited", "Inspection", "RecordingInspection", "Remark", "inspect", "inspection_dict"]
