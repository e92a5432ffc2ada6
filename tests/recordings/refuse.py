"""How a recording is refused: in one line that names file, column, row and remedy, and exit code 2."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.data_helpers import two_axes, write_recording
from workbench.core import InputError
from workbench.recordings import load_recording


def refused(path: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        load_recording(path)
    error = caught.value
    assert error.exit_code == 2
    assert error.remedy, f"no remedy in: {error}"
    assert "\n" not in str(error)
    assert error.file is not None
    return error


def refused_table(folder: Path, changed: dict[str, Any], **changes: Any) -> InputError:
    error = refused(write_recording(folder, {**two_axes(), **changed}, **changes))
    assert Path(str(error.file)).name == "table.csv"
    return error


def refused_key(folder: Path, **changes: Any) -> InputError:
    error = refused(write_recording(folder, **changes))
    assert Path(str(error.file)).name == "made.toml"
    return error


def changed(column: str, row: int, value: Any) -> dict[str, Any]:
    """The column with one cell changed; rows count from 1."""
    cells: list[Any] = list(two_axes()[column])
    cells[row - 1] = value
    return {column: cells}
