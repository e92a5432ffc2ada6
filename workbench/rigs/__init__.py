"""Where measurements come from: virtual hardware, a closed chain in Drake with effects hidden in it."""

from workbench.mechanism import ClosedChain, Reduced

from .bench import VirtualBench
from .degrade import degrade
from .draw import draw_hidden, draw_several
from .drive_side import DriveSide, drive_side
from .drive_train import DriveTrain
from .experiments import Experiment, chirp, demo_experiments, multisine, slow_sweep, validation
from .hidden import EFFECTS, OUTSIDERS, HiddenEffect
from .live import LiveLeg, LiveShaft
from .live_own import LiveOwn
from .magnitudes import DEMO_EFFECTS, DRAWN_EFFECTS
from .motor_bank import MotorBank
from .own_draw import draw_own
from .own_machine import HIDEABLE, HiddenIn, OwnMachine
from .own_rig import OwnExperiment, OwnRig
from .plate_experiments import plate_experiments
from .revealing import (
    dither,
    experiments_for,
    range_sweep,
    revealing_experiments,
    speed_ladder,
    steps,
    work_and_rest,
)
from .shapes import hidden_effect
from .standing_leg import Plate
from .structure import LegStructure, leg_structure
from .virtual_leg import PERFECT, Sensors, VirtualLeg
from .virtual_motor import VirtualMotor

__all__ = [
    "DEMO_EFFECTS",
    "DRAWN_EFFECTS",
    "EFFECTS",
    "HIDEABLE",
    "OUTSIDERS",
    "PERFECT",
    "ClosedChain",
    "DriveSide",
    "DriveTrain",
    "Experiment",
    "HiddenEffect",
    "HiddenIn",
    "LegStructure",
    "LiveLeg",
    "LiveOwn",
    "LiveShaft",
    "MotorBank",
    "OwnExperiment",
    "OwnMachine",
    "OwnRig",
    "Plate",
    "Reduced",
    "Sensors",
    "VirtualBench",
    "VirtualLeg",
    "VirtualMotor",
    "chirp",
    "degrade",
    "demo_experiments",
    "dither",
    "draw_hidden",
    "draw_own",
    "draw_several",
    "drive_side",
    "experiments_for",
    "hidden_effect",
    "leg_structure",
    "multisine",
    "plate_experiments",
    "range_sweep",
    "revealing_experiments",
    "slow_sweep",
    "speed_ladder",
    "steps",
    "validation",
    "work_and_rest",
]
