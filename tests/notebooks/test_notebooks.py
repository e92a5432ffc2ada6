"""Every notebook is committed as it ran, small and with its picture, and runs again from top to bottom."""

from __future__ import annotations

import base64
from pathlib import Path

import nbformat
import pytest
import run_notebooks
from nbformat import NotebookNode

from tests.data_helpers import data_folder

FILES = sorted(run_notebooks.NOTEBOOKS.glob("*.ipynb"))
ONE_MB = 1_000_000


def pictures(notebook: NotebookNode) -> list[bytes]:
    data = [o["data"] for c in notebook.cells for o in c.get("outputs", ()) if "data" in o]
    return [base64.b64decode(d["image/png"]) for d in data if "image/png" in d]


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_is_committed_as_it_ran(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert path.stat().st_size < ONE_MB
    assert [c.cell_type for c in notebook.cells][:2] == ["markdown", "code"]
    ran = [c.execution_count for c in notebook.cells if c.cell_type == "code"]
    assert ran == list(range(1, len(ran) + 1))
    assert any(p.startswith(b"\x89PNG") for p in pictures(notebook))
    text = path.read_text(encoding="utf-8")
    assert "sys.path" not in text and "/home/" not in text and "Traceback" not in text


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_runs(path: Path) -> None:
    if "WORKBENCH_DATA" in path.read_text(encoding="utf-8"):
        data_folder("emps")  # skips where the measured data are not at hand
    assert pictures(run_notebooks.executed(path))  # its own assertions hold


def test_there_are_notebooks() -> None:
    assert FILES
