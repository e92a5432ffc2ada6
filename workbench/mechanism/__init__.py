"""The closed chain in Drake: the reference dynamics."""

from .closed_chain import ClosedChain
from .discrete import DiscreteChain
from .ground import Ground
from .hold import held_rest
from .linear import linearise
from .reduced import Reduced
from .simulate import Motion, simulate
from .transmission import constant_transmission, sample_joints

__all__ = [
    "ClosedChain", "DiscreteChain", "Ground", "Motion", "Reduced", "constant_transmission", "held_rest",
    "linearise", "sample_joints", "simulate",
]  # fmt: skip
