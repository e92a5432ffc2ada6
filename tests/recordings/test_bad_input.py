"""Every bad input gives one line that names file, column, row and remedy, and exit code 2."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from tests.data_helpers import csv_text, description, two_axes, write_recording, write_toml
from workbench.core import InputError
from workbench.recordings import load_recording, load_recordings


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


def test_missing_toml(tmp_path: Path) -> None:
    error = refused(tmp_path / "nowhere.toml")
    assert "nowhere.toml" in str(error) and "No such file" in error.problem


def test_missing_table(tmp_path: Path) -> None:
    error = refused(write_toml(tmp_path / "made.toml", description(table="gone.csv")))
    assert "gone.csv" in str(error) and "missing" in error.problem and "relative" in error.remedy


def test_malformed_toml_names_the_line(tmp_path: Path) -> None:
    path = tmp_path / "made.toml"
    path.write_text("format = 1\nname = \n")
    assert "line 2" in refused(path).problem


def test_a_folder_named_as_the_table(tmp_path: Path) -> None:
    (tmp_path / "gone.csv").mkdir()
    error = refused(write_toml(tmp_path / "made.toml", description(table="gone.csv")))
    assert "gone.csv" in str(error) and "is a folder" in error.problem and "relative" in error.remedy


def test_a_table_handed_in_as_toml(tmp_path: Path) -> None:
    path = tmp_path / "made.toml"
    path.write_bytes(gzip.compress(b"t,q\n0,1\n"))
    assert "TOML" in refused(path).remedy


@pytest.mark.parametrize(
    ("name", "text", "remedy"),
    [
        ("run.csv", "t,q\n0,1\n", "workbench import {folder}/run.csv"),
        ("arm.xml", "<mujoco/>", "it is a model, which comes first"),
        ("arm.toml", 'format = 1\nname = "arm"\nserial = "arm.xml"\n', "it is a model, which comes first"),
    ],
)
def test_what_is_no_recording_is_told_what_to_do_with_it(
    tmp_path: Path, name: str, text: str, remedy: str
) -> None:
    (tmp_path / name).write_text(text)
    error = refused(tmp_path / name)
    assert error.problem == "is not a recording" and remedy.format(folder=tmp_path) in str(error)


@pytest.mark.parametrize("version", [0, "1"])
def test_other_format(tmp_path: Path, version: Any) -> None:
    error = refused_key(tmp_path, format=version)
    assert error.column == "format" and "format = 1" in error.remedy


def test_unknown_key_names_the_closest(tmp_path: Path) -> None:
    error = refused_key(tmp_path, excitation={"kind": "chirp", "fmax_hz": 3.0})
    assert error.column == "excitation.fmax_hz" and "f_max_hz" in error.remedy


def test_unknown_signal_names_the_closest(tmp_path: Path) -> None:
    columns = {**description()["columns"], "velocty": ["w_a", "w_b"]}
    error = refused_key(tmp_path, columns=columns)
    assert error.column == "columns.velocty" and "'velocity'" in error.remedy


def test_unknown_unit_kind(tmp_path: Path) -> None:
    assert "'torque'" in refused_key(tmp_path, units={"torqe": "N*m"}).remedy


def test_missing_key(tmp_path: Path) -> None:
    content = description()
    del content["axes"]
    error = refused(write_toml(tmp_path / "made.toml", content))
    assert error.column == "axes" and error.problem == "is missing"


@pytest.mark.parametrize("signal", ["time", "position"])
def test_needed_signal(tmp_path: Path, signal: str) -> None:
    columns = {k: v for k, v in description()["columns"].items() if k != signal}
    assert refused_key(tmp_path, columns=columns).column == f"columns.{signal}"


def test_duplicate_axes(tmp_path: Path) -> None:
    error = refused_key(tmp_path, axes=["a", "a"])
    assert error.column == "axes" and "'a' is named twice" in error.problem


def test_one_column_is_not_the_position_of_two_axes(tmp_path: Path) -> None:
    columns = {**description()["columns"], "position": ["q_a", "q_a"]}
    error = refused_key(tmp_path, columns=columns)
    assert error.column == "columns.position" and "'q_a' is the position of a and b" in error.problem


def test_wrong_number_of_columns(tmp_path: Path) -> None:
    columns = {**description()["columns"], "velocity": ["w_a"]}
    error = refused_key(tmp_path, columns=columns)
    assert error.column == "columns.velocity" and "1 column where 2" in error.problem


def test_unknown_unit(tmp_path: Path) -> None:
    error = refused_key(tmp_path, units={"position": "wibble"})
    assert (
        error.column == "units.position"
        and "unknown unit 'wibble'" in error.problem
        and "rad" in error.remedy
    )


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_gain_that_is_no_number_is_told_so(tmp_path: Path, value: float) -> None:
    error = refused_key(tmp_path, controller={"kind": "pd", "kp": [1.0, value], "kd": [1.0, 1.0]})
    assert "must be a finite number" in error.problem


def test_unit_of_another_dimension(tmp_path: Path) -> None:
    error = refused_key(tmp_path, units={"velocity": "kg"})
    assert error.column == "units.velocity" and "'kg' is not a unit of velocity" in error.problem


def test_torque_unit_must_fit_the_axis(tmp_path: Path) -> None:
    error = refused_key(tmp_path, units={"torque": "N"})
    assert error.column == "units.torque" and "'a' turns" in error.problem and "N*m" in error.remedy


@pytest.mark.parametrize(
    ("controller", "column"),
    [
        ({"kind": "pd", "kp": [1.0]}, "controller.kp"),
        ({"kind": "pd"}, "controller.kp"),
        ({"kind": "pd", "kp": [1.0, float("inf")]}, "controller.kp"),
        ({"kind": "pd", "kp": [1.0, 1.0], "period_s": 0.0}, "controller.period_s"),
        ({"kind": "cascade_pv", "kp": [1.0, 1.0], "kv": [1.0, 1.0]}, "controller.gain"),
        ({"kind": "pid"}, "controller.kind"),
        ({"kind": "pd", "kp": [1.0, -1.0]}, "controller.kp.1"),
        ({"kind": "pd", "kp": [1.0, 1.0], "kd": -0.1}, "controller.kd"),
        (
            {"kind": "cascade_pv", "kp": 1.0, "kv": 1.0, "gain": 1.0, "limit": [0.0, 1.0]},
            "controller.limit.0",
        ),
    ],
)
def test_controller(tmp_path: Path, controller: dict[str, Any], column: str) -> None:
    error = refused_key(tmp_path, controller=controller)
    assert str(error.column).startswith(column)


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
