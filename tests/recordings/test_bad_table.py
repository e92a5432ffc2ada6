"""Every bad table gives one line that names file, column, row and remedy, and exit code 2."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from tests.data_helpers import csv_text, description, two_axes, write_recording
from workbench.core import InputError
from workbench.recordings import load_recording, load_recordings

from .refuse import changed, refused, refused_table


def test_missing_column_names_the_closest(tmp_path: Path) -> None:
    columns = {**description()["columns"], "velocity": ["w_a", "w_bb"]}
    error = refused_table(tmp_path, {}, columns=columns)
    assert error.column == "w_bb" and "'w_b'" in error.remedy


def test_time_goes_back(tmp_path: Path) -> None:
    error = refused_table(tmp_path, changed("t", 8, 0.001))
    assert error.column == "t" and error.row == 8 and "goes back" in error.problem


def test_time_repeats(tmp_path: Path) -> None:
    t = two_axes()["t"]
    error = refused_table(tmp_path, changed("t", 8, t[6]))
    assert error.row == 8 and "repeats" in error.problem


def test_missing_rows_without_valid_column(tmp_path: Path) -> None:
    table = {k: np.delete(v, [100, 101]) for k, v in two_axes().items()}
    error = refused(write_recording(tmp_path, table))
    assert error.row == 101 and "jumps by 3 periods" in error.problem and "`valid`" in error.remedy


def test_cell_that_is_no_number(tmp_path: Path) -> None:
    error = refused_table(tmp_path, changed("w_b", 5, "oops"))
    assert error.column == "w_b" and error.row == 5 and "'oops'" in error.problem


@pytest.mark.parametrize(("value", "word"), [(np.nan, "NaN"), (np.inf, "infinite"), ("", "empty")])
def test_cell_that_is_not_finite(tmp_path: Path, value: Any, word: str) -> None:
    error = refused_table(tmp_path, changed("q_b", 9, value))
    assert error.column == "q_b" and error.row == 9 and word in error.problem and "`valid`" in error.remedy


def test_time_that_is_nan(tmp_path: Path) -> None:
    error = refused_table(tmp_path, changed("t", 9, np.nan))
    assert error.column == "t" and error.row == 9


def test_valid_that_is_no_flag(tmp_path: Path) -> None:
    columns = {**description()["columns"], "valid": "ok"}
    flags = [1.0] * 400
    flags[2] = 3.0
    error = refused_table(tmp_path, {"ok": flags}, columns=columns)
    assert error.column == "ok" and error.row == 3


def test_shorter_than_one_excitation_period(tmp_path: Path) -> None:
    error = refused_table(tmp_path, {}, excitation={"kind": "multisine", "period_s": 5.0})
    assert "2 s" in error.problem and "5 s" in error.problem and "whole period" in error.remedy


def test_rate_too_low_for_the_excitation(tmp_path: Path) -> None:
    error = refused_table(tmp_path, {}, excitation={"kind": "chirp", "f_max_hz": 100.0})
    assert "200 Hz" in error.problem and "100 Hz" in error.problem


@pytest.mark.parametrize("column", ["q_b", "w_b", "tau_b"])
def test_dead_signal_of_an_excited_axis(tmp_path: Path, column: str) -> None:
    error = refused_table(tmp_path, {column: [0.25] * 400})
    assert error.column == column and "never changes" in error.problem and "'b'" in error.problem


def test_an_axis_whose_drive_was_off_may_stand_still(tmp_path: Path) -> None:
    data = two_axes()
    data |= {"q_b": np.full(400, 0.25), "w_b": np.zeros(400), "u_a": data["tau_a"], "u_b": np.zeros(400)}
    columns = {**description()["columns"], "torque_command": ["u_a", "u_b"]}
    assert load_recording(write_recording(tmp_path, data, columns=columns)).position[0, 1] == 0.25


def test_everything_stands_still(tmp_path: Path) -> None:
    columns = {k: v for k, v in description()["columns"].items() if k != "position_reference"}
    still = {k: [0.0] * 400 for k in ("q_a", "q_b")}
    assert refused_table(tmp_path, still, columns=columns).column == "q_a"


def test_header_only(tmp_path: Path) -> None:
    assert "no rows" in refused(write_recording(tmp_path, {k: [] for k in two_axes()})).problem


def test_empty_file(tmp_path: Path) -> None:
    path = write_recording(tmp_path)
    (tmp_path / "table.csv").write_text("")
    assert "empty" in refused(path).problem


def test_one_row(tmp_path: Path) -> None:
    error = refused(write_recording(tmp_path, {k: v[:1] for k, v in two_axes().items()}))
    assert error.column == "t" and "1 row: too few" in error.problem


def test_ragged_row(tmp_path: Path) -> None:
    path = write_recording(tmp_path)
    lines = csv_text(two_axes()).splitlines()
    lines[4] += ",1"
    (tmp_path / "table.csv").write_text("\n".join(lines))
    assert "9 cells" in refused(path).remedy


def test_truncated_gzip(tmp_path: Path) -> None:
    path = write_recording(tmp_path, table="table.csv.gz")
    (tmp_path / "table.csv.gz").write_bytes(gzip.compress(csv_text(two_axes()).encode())[:-2000])
    assert "whole" in refused(path).remedy


@pytest.mark.parametrize("ending", ["mcap", "npz", "txt"])
def test_what_is_to_be_imported_first(tmp_path: Path, ending: str) -> None:
    error = refused(write_recording(tmp_path, table=f"table.{ending}"))
    assert f"workbench import table.{ending}" in error.remedy


def test_unknown_table_format(tmp_path: Path) -> None:
    assert ".parquet" in refused(write_recording(tmp_path, table="table.xlsx")).remedy


def test_matlab_lengths_differ(tmp_path: Path) -> None:
    path = write_recording(tmp_path, table="table.mat")
    savemat(tmp_path / "table.mat", {**two_axes(), "w_a": np.arange(5.0)})
    error = refused(path)
    assert error.column == "w_a" and "5 rows" in error.problem


def test_matlab_channel(tmp_path: Path) -> None:
    columns = {**description()["columns"], "velocity": ["w[0]", "w[2]"]}
    path = write_recording(tmp_path, table="table.mat", columns=columns)
    data = two_axes()
    savemat(tmp_path / "table.mat", {**data, "w": np.column_stack([data["w_a"], data["w_b"]])})
    error = refused(path)
    assert error.column == "w[2]" and "0 to 1" in error.remedy


def test_pattern_that_finds_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file matches"):
        load_recordings([tmp_path / "*.toml"])
