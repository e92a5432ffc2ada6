"""Runs a model the way a recording was made, one or thousands at once."""

from .control import SensorNoise
from .experiment import Experiment, check_axes, prepare
from .run import Run, simulate

__all__ = ["Experiment", "Run", "SensorNoise", "check_axes", "prepare", "simulate"]
