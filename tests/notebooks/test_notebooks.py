"""Every notebook runs from top to bottom, and its own assertions hold."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

_NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.py"))


@pytest.mark.parametrize("path", _NOTEBOOKS, ids=lambda p: p.stem)
def test_runs(path: Path) -> None:
    names = runpy.run_path(str(path))
    assert "figure" in names


def test_there_are_notebooks() -> None:
    assert _NOTEBOOKS
