"""Errors are one line each, and outputs appear whole or not at all."""

from pathlib import Path

import pytest

from workbench.core import EffectKey, InputError, SimulationError, WorkbenchError
from workbench.core.files import check_free, write_whole


def test_an_input_error_says_where_what_and_how() -> None:
    error = InputError("is\n empty", file="a.csv", column="t", row=3, remedy="fill it")
    assert str(error) == "a.csv, column 't', row 3: is empty; fill it"
    assert (error.file, error.column, error.row, error.remedy) == ("a.csv", "t", 3, "fill it")
    assert str(InputError("nothing given")) == "nothing given"


def test_a_toml_file_has_keys_and_a_table_columns() -> None:
    assert (
        str(InputError("is wrong", file="a.toml", column="units.time"))
        == "a.toml, key 'units.time': is wrong"
    )
    assert str(InputError("is wrong", file="a.csv.gz", column="t")) == "a.csv.gz, column 't': is wrong"
    assert str(InputError("is wrong", column="--rate")) == "option '--rate': is wrong"


def test_all_errors_have_one_root_and_one_exit_code() -> None:
    for kind in (InputError, SimulationError):
        assert issubclass(kind, WorkbenchError)
        assert kind("x").exit_code == 2


def test_a_file_is_replaced_only_by_force(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "file.txt"
    write_whole(target, "one")
    with pytest.raises(InputError, match=r"exists.*--force"):
        write_whole(target, "two")
    with pytest.raises(InputError, match=r"exists.*--force"):
        check_free(target, force=False)
    assert target.read_text() == "one"
    write_whole(target, b"two", force=True)
    assert target.read_text() == "two"
    assert [p.name for p in target.parent.iterdir()] == ["file.txt"]


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot write"):
        write_whole(tmp_path / "file" / "inside.txt", "x")


def test_a_key_reads_as_it_is_typed() -> None:
    assert str(EffectKey("coulomb_friction", "knee")) == "coulomb_friction@knee"
    assert str(EffectKey("coulomb_friction", "knee", "joint")) == "coulomb_friction@knee(joint)"
    assert str(EffectKey("payload_mass", None)) == "payload_mass"
