"""Experiments and policies on hardware over CAN: safety, the loop, recorder and runner."""

from .limits import Limits, limits_of
from .safety import SafetyState, Seen, Setpoints, Wanted, initial, step

__all__ = ["Limits", "SafetyState", "Seen", "Setpoints", "Wanted", "initial", "limits_of", "step"]
