"""The closed chain in Drake: the reference dynamics."""

from .closed_chain import ClosedChain, Margin, Reduced
from .discrete import DiscreteChain
from .ground import Ground
from .hold import held_rest
from .linear import LinearPlant, linearise
from .simulate import Motion, simulate
from .transmission import Transmission, constant_transmission, sample_joints

__all__ = [
    "ClosedChain",
    "DiscreteChain",
    "Ground",
    "LinearPlant",
    "Margin",
    "Motion",
    "Reduced",
    "Transmission",
    "constant_transmission",
    "held_rest",
    "linearise",
    "sample_joints",
    "simulate",
]
