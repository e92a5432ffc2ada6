"""Every notebook runs from top to bottom, and its own assertions hold."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from tests.data_helpers import data_folder

_NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.py"))


@pytest.mark.parametrize("path", _NOTEBOOKS, ids=lambda p: p.stem)
def test_runs(path: Path) -> None:
    if "WORKBENCH_DATA" in path.read_text(encoding="utf-8"):
        data_folder("emps")  # skips where the measured data are not at hand
    names = runpy.run_path(str(path))
    assert "figure" in names


def test_there_are_notebooks() -> None:
    assert _NOTEBOOKS
