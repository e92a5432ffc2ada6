"""Where measurements come from: virtual hardware, a closed chain in Drake with effects hidden in it."""

from workbench.mechanism import ClosedChain, Reduced

from .draw import draw_hidden, hidden_effect
from .experiments import Experiment, chirp, demo_experiments, multisine, slow_sweep, validation
from .hidden import EFFECTS, OUTSIDERS, HiddenEffect
from .structure import LegStructure, leg_structure
from .virtual_leg import PERFECT, Sensors, VirtualLeg

__all__ = [
    "EFFECTS",
    "OUTSIDERS",
    "PERFECT",
    "ClosedChain",
    "Experiment",
    "HiddenEffect",
    "LegStructure",
    "Reduced",
    "Sensors",
    "VirtualLeg",
    "chirp",
    "demo_experiments",
    "draw_hidden",
    "hidden_effect",
    "leg_structure",
    "multisine",
    "slow_sweep",
    "validation",
]
