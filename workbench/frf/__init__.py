"""Frequency responses: excitation, and estimation with uncertainty."""

from .channel import Channel
from .chirp import chirp
from .design_file import load_design, save_design
from .distortion import Distortion, distortion
from .estimate import estimate
from .excitation import Design
from .limits import Limit, Scaled, scale_to_limits
from .lines import detection_lines, select_lines
from .local_polynomial import local_polynomial
from .measure import lines_of
from .mixing import mixing_matrix
from .multisine import multisine
from .period import find_period
from .phases import crest_factor
from .postures import estimate_postures, group_by_posture
from .resonances import Resonance, find_resonances
from .response import Frf

__all__ = [
    "Channel", "Design", "Distortion", "Frf", "Limit", "Resonance", "Scaled", "chirp", "crest_factor",
    "detection_lines", "distortion", "estimate", "estimate_postures", "find_period", "find_resonances",
    "group_by_posture", "lines_of", "load_design", "local_polynomial", "mixing_matrix", "multisine",
    "save_design", "scale_to_limits", "select_lines",
]  # fmt: skip
