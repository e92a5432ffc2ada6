"""Every bad TOML of a recording gives one line that names file, key and remedy, and exit code 2."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import pytest

from tests.data_helpers import description, write_toml

from .refuse import refused, refused_key


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
