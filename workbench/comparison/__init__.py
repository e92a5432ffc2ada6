"""How far a model is from measurements, and where."""

from .compare import Simulated, check_recordings, compare, evaluate, simulate_with_noise
from .inverse import needs_inverse
from .noise import DRAWS, NoiseModel
from .score import Scale, normalised, scored_signals

__all__ = [
    "DRAWS",
    "NoiseModel",
    "Scale",
    "Simulated",
    "check_recordings",
    "compare",
    "evaluate",
    "needs_inverse",
    "normalised",
    "scored_signals",
    "simulate_with_noise",
]
