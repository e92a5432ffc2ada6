"""Drives and parallel legs from frequency responses, S3N built from them (paper, Algorithm 1), and links."""

from .actuator import fit_actuator
from .build import check_physical, serial_form, with_actuator, with_leg
from .fit import Fit
from .identify import identify_actuator, identify_leg
from .leg import fit_leg
from .links import identify_links
from .links_page import axis_rows, link_rows, links_sentences, links_sheet
from .page import actuator_sheet, leg_sheet, readable
from .picture import actuator_figure, fit_figure, links_figure
from .result import ActuatorIdentification, LegIdentification, LinksIdentification

__all__ = [
    "ActuatorIdentification",
    "Fit",
    "LegIdentification",
    "LinksIdentification",
    "actuator_figure",
    "actuator_sheet",
    "axis_rows",
    "check_physical",
    "fit_actuator",
    "fit_figure",
    "fit_leg",
    "identify_actuator",
    "identify_leg",
    "identify_links",
    "leg_sheet",
    "link_rows",
    "links_figure",
    "links_sentences",
    "links_sheet",
    "readable",
    "serial_form",
    "with_actuator",
    "with_leg",
]  # fmt: skip
