"""Results for people and programs: terminal tables, JSON, figures, and one self-contained page."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .json import comparison_dict, diagnosis_dict, improvement_dict, verification_dict, write_json
from .json_parts import effect_dict
from .layout import print_table
from .verification import verification_table

if TYPE_CHECKING:
    from .check_sheet import verification_sheet
    from .figures import ladder_figure, overlay_figure, residual_figure, spectrum_figure
    from .gait import gait_dict, gait_table
    from .mcap_file import check_mcap, write_mcap
    from .motion import check_film
    from .page import render_page, write_page
    from .rerun_file import check_rerun, write_rerun
    from .search_sheet import trace_sheet
    from .sections import sentence
    from .shapes import shape_figure
    from .sheet import Sheet
    from .sheet_page import render_sheet, write_sheet
    from .style import check_figure, house_style, save_figure
    from .tables import compare_table, diagnosis_table, improvement_table, truth_table

__all__ = [
    "Sheet", "check_figure", "check_film", "check_mcap", "check_rerun", "compare_table", "comparison_dict",
    "diagnosis_dict", "diagnosis_table", "effect_dict", "gait_dict", "gait_table", "house_style",
    "improvement_dict", "improvement_table", "ladder_figure", "overlay_figure", "print_table",
    "render_page", "render_sheet", "residual_figure", "save_figure", "sentence", "shape_figure",
    "spectrum_figure", "trace_sheet", "truth_table", "verification_dict", "verification_sheet",
    "verification_table", "write_json", "write_mcap", "write_page", "write_rerun", "write_sheet",
]  # fmt: skip

_NAMES = {
    "check_sheet": "verification_sheet",
    "figures": "ladder_figure overlay_figure residual_figure spectrum_figure",
    "gait": "gait_dict gait_table",
    "mcap_file": "check_mcap write_mcap",
    "motion": "check_film",
    "page": "render_page write_page",
    "rerun_file": "check_rerun write_rerun",
    "search_sheet": "trace_sheet",
    "sections": "sentence",
    "shapes": "shape_figure",
    "sheet": "Sheet",
    "sheet_page": "render_sheet write_sheet",
    "style": "check_figure house_style save_figure",
    "tables": "compare_table diagnosis_table improvement_table truth_table",
}
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    """What draws is imported on first use: most results are a table, and matplotlib is slow to load."""
    if name in _HOME:
        return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
