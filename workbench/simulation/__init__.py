"""Simulates a model as a recording was made, one run or thousands at once."""

from .control import SensorNoise
from .cores import on_all_cores, use_cores
from .designs import as_recording, held_posture, holds, joint_limits, limits_of, predictor, whole_period
from .experiment import GROUND_TORQUE, Experiment, check_axes, prepare, scored_torque
from .holding import check_held, with_loop_of
from .inverse import required_torque, rigid_torque
from .known_rows import edge_rows
from .law import law_torque
from .linear import Loop, linearise, slopes
from .motion import mass_matrix, motion_of
from .posture_drives import runs_in_loop
from .posture_run import PosturePlant, refuse_joint_coordinates, run_posture
from .propagate import Disturbance, propagate
from .run import Run, simulate
from .sense import true_motion
from .shooting import Tangents, Windows, shoot
from .steps import LONGEST_STEP, as_made, steps_of, whole_steps
from .trajectory import TRUE_MOTION, Track, interpolate, joint_columns, smooth_track
from .unlogged_rate import differentiates, rate_read

__all__ = [
    "GROUND_TORQUE", "LONGEST_STEP", "TRUE_MOTION", "Disturbance", "Experiment", "Loop", "PosturePlant",
    "Run", "SensorNoise", "Tangents", "Track", "Windows", "as_made", "as_recording", "check_axes",
    "check_held", "differentiates", "edge_rows", "held_posture", "holds", "interpolate", "joint_columns",
    "joint_limits", "law_torque", "limits_of", "linearise", "mass_matrix", "motion_of", "on_all_cores",
    "predictor", "prepare", "propagate", "rate_read", "refuse_joint_coordinates",
    "required_torque", "rigid_torque", "run_posture", "runs_in_loop", "scored_torque", "shoot",
    "simulate", "slopes", "smooth_track", "steps_of", "true_motion", "use_cores", "whole_period",
    "whole_steps",    "with_loop_of",
]  # fmt: skip
