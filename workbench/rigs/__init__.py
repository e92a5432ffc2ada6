"""Sources of measurements: virtual hardware, a closed chain in Drake with hidden effects."""

from workbench.mechanism import ClosedChain

from .bench import VirtualBench
from .draw import draw_hidden
from .experiments import Experiment, chirp, demo_experiments, multisine, slow_sweep, validation
from .hidden import EFFECTS, OUTSIDERS, HiddenEffect
from .live import LiveLeg, LiveShaft
from .magnitudes import DEMO_EFFECTS, DRAWN_EFFECTS
from .motor_bank import MotorBank
from .own_draw import draw_own
from .own_machine import HiddenIn
from .own_rig import OwnExperiment
from .plate_experiments import plate_experiments
from .revealing import revealing_experiments, work_and_rest
from .shapes import hidden_effect
from .standing_leg import Plate
from .structure import LegStructure, leg_structure
from .virtual_leg import PERFECT, Sensors, VirtualLeg
from .virtual_motor import VirtualMotor

__all__ = [
    "DEMO_EFFECTS", "DRAWN_EFFECTS", "EFFECTS", "OUTSIDERS", "PERFECT", "ClosedChain", "Experiment",
    "HiddenEffect", "HiddenIn", "LegStructure", "LiveLeg", "LiveShaft", "MotorBank", "OwnExperiment",
    "Plate", "Sensors", "VirtualBench", "VirtualLeg", "VirtualMotor", "chirp", "demo_experiments",
    "draw_hidden", "draw_own", "hidden_effect", "leg_structure", "multisine", "plate_experiments",
    "revealing_experiments", "slow_sweep", "validation", "work_and_rest",
]  # fmt: skip
