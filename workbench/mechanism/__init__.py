"""The closed chain in Drake: the reference dynamics."""

from .closed_chain import ClosedChain, Margin, Reduced
from .transmission import Transmission, constant_transmission, sample_joints

__all__ = [
    "ClosedChain",
    "Margin",
    "Reduced",
    "Transmission",
    "constant_transmission",
    "sample_joints",
]
