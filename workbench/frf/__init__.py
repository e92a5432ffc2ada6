"""Frequency responses: excitation, estimation with uncertainty, parametric fits."""

from .chirp import chirp
from .design_file import load_design, save_design
from .excitation import Design, Trial
from .limits import Limit, Scaled, scale_to_limits
from .lines import detection_lines, select_lines
from .mixing import mixing_matrix
from .multisine import multisine
from .phases import crest_factor, low_crest_phases, random_phases, schroeder_phases

__all__ = [
    "Design",
    "Limit",
    "Scaled",
    "Trial",
    "chirp",
    "crest_factor",
    "detection_lines",
    "load_design",
    "low_crest_phases",
    "mixing_matrix",
    "multisine",
    "random_phases",
    "save_design",
    "scale_to_limits",
    "schroeder_phases",
    "select_lines",
]
