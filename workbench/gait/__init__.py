"""How a legged robot moves in two recordings: tracking, strides, cycles, and the swing leg's prediction."""

from .bootstrap import Interval, resampled
from .compare import Gait, Measure, compare_gaits
from .cycle import Cycles, cycle_gap, cycles_of
from .odometry import with_leg_odometry
from .strides import Strides, duty_factor, strides_of
from .swing import Limbs, SwingPrediction, limbs_of, predict_swing
from .tracking import Parts, Tracking, split, tracking

__all__ = [
    "Cycles",
    "Gait",
    "Interval",
    "Limbs",
    "Measure",
    "Parts",
    "Strides",
    "SwingPrediction",
    "Tracking",
    "compare_gaits",
    "cycle_gap",
    "cycles_of",
    "duty_factor",
    "limbs_of",
    "predict_swing",
    "resampled",
    "split",
    "strides_of",
    "tracking",
    "with_leg_odometry",
]
