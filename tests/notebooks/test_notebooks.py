"""Every notebook runs from top to bottom, its own assertions hold, and it shows its figure."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from tests.data_helpers import data_folder

_NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.py"))


@pytest.mark.parametrize("path", _NOTEBOOKS, ids=lambda p: p.stem)
def test_runs(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    if "WORKBENCH_DATA" in text:
        data_folder("emps")  # skips where the measured data are not at hand
    names = runpy.run_path(str(path))
    assert names["figure"]._repr_png_().startswith(b"\x89PNG")
    cells = re.split(r"^# %%.*$", text, flags=re.MULTILINE)
    assert any(cell.rstrip().endswith("\nfigure") for cell in cells), "no cell ends with the figure"


def test_there_are_notebooks() -> None:
    assert _NOTEBOOKS
