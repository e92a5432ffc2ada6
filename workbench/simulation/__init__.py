"""Runs a model the way a recording was made, one or thousands at once."""

from .control import SensorNoise
from .experiment import Experiment, check_axes, prepare, scored_torque
from .linear import Loop, linearise, propagate
from .run import Run, simulate
from .trajectory import Track, joint_columns, motion_of, smooth_track

__all__ = [
    "Experiment",
    "Loop",
    "Run",
    "SensorNoise",
    "Track",
    "check_axes",
    "joint_columns",
    "linearise",
    "motion_of",
    "prepare",
    "propagate",
    "scored_torque",
    "simulate",
    "smooth_track",
]
