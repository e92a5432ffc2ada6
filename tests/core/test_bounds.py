"""What stands in the place of a file is told from the file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.data_helpers import write_recording
from tests.recordings.refuse import refused
from workbench.core import InputError
from workbench.proposing import open_table

_POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:55b94c07e86a\nsize 2012328\n"


@pytest.mark.parametrize("name", ["run.csv", "run.npz", "run.mat", "run.parquet", "run.mcap"])
def test_a_log_that_was_not_fetched_is_imported_from_no_pointer(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(_POINTER)
    with pytest.raises(InputError, match="not fetched with Git LFS") as caught:
        open_table(tmp_path / name)
    assert caught.value.remedy and "git lfs pull" in caught.value.remedy


def test_nor_is_a_recording_read_from_one(tmp_path: Path) -> None:
    recording = write_recording(tmp_path)
    (tmp_path / "table.csv").write_text(_POINTER)
    assert "not fetched with Git LFS" in refused(recording).problem
