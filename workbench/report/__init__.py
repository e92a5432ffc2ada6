"""Results for people and programs: terminal tables, JSON, figures, and one self-contained page."""

from .figures import house_style, ladder_figure, overlay_figure, residual_figure, save_figure, spectrum_figure
from .json import comparison_dict, diagnosis_dict, improvement_dict, verification_dict, write_json
from .layout import print_table
from .page import render_page, write_page
from .sections import sentence
from .shapes import shape_figure
from .sheet import Sheet, render_sheet, write_sheet
from .tables import compare_table, diagnosis_table, improvement_table, truth_table
from .verification import verification_table
from .verification_sheet import verification_sheet

__all__ = [
    "Sheet",
    "compare_table",
    "comparison_dict",
    "diagnosis_dict",
    "diagnosis_table",
    "house_style",
    "improvement_dict",
    "improvement_table",
    "ladder_figure",
    "overlay_figure",
    "print_table",
    "render_page",
    "render_sheet",
    "residual_figure",
    "save_figure",
    "sentence",
    "shape_figure",
    "spectrum_figure",
    "truth_table",
    "verification_dict",
    "verification_sheet",
    "verification_table",
    "write_json",
    "write_page",
    "write_sheet",
]
