"""How a legged robot moves in two recordings: tracking, strides, cycles, and the swing leg's prediction."""

from .bootstrap import Interval, resampled
from .compare import compare_gaits
from .measures import Gait, Measure
from .odometry import velocity_by_foot, with_leg_odometry
from .strides import strides_of
from .swing import Limbs, limbs_of, predict_swing
from .tracking import split, tracking

__all__ = [
    "Gait",
    "Interval",
    "Limbs",
    "Measure",
    "compare_gaits",
    "limbs_of",
    "predict_swing",
    "resampled",
    "split",
    "strides_of",
    "tracking",
    "velocity_by_foot",
    "with_leg_odometry",
]
