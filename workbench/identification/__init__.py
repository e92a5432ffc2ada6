"""Actuator and leg parameters from frequency responses, and S3N built from them (paper, Algorithm 1)."""

from .actuator import fit_actuator
from .build import check_physical, serial_form, with_actuator, with_leg
from .fit import Fit
from .identify import identify_actuator, identify_leg
from .leg import fit_leg
from .page import actuator_sheet, leg_sheet, readable
from .picture import actuator_figure, fit_figure
from .result import ActuatorIdentification, LegIdentification
from .two_mass import fit_two_mass, two_mass_numbers

__all__ = [
    "ActuatorIdentification", "Fit", "LegIdentification", "actuator_figure", "actuator_sheet",
    "check_physical", "fit_actuator", "fit_figure", "fit_leg", "fit_two_mass", "identify_actuator",
    "identify_leg", "leg_sheet", "readable", "serial_form", "two_mass_numbers", "with_actuator",
    "with_leg",
]  # fmt: skip
