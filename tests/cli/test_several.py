"""Several files at once: models among recordings are left out, alike logs are imported in one go."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path

import pytest

from tests.cli.here import run
from workbench.core import InputError
from workbench.core.paths import models_folder
from workbench.effects import load_model
from workbench.models import write_model
from workbench.recordings import load_recordings

TUTORIAL = Path(__file__).resolve().parents[2] / "docs" / "tutorial"


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("several")
    for name in ("arm.xml", "sweep.csv", "check.csv"):
        shutil.copy(TUTORIAL / name, folder)
    done = run("import", "sweep.csv", "check.csv", "--model", "arm.xml", "-o", "data", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_logs_that_are_alike_become_recordings_in_one_folder(imported: Path) -> None:
    assert sorted(p.name for p in (imported / "data").glob("*.toml")) == ["check.toml", "sweep.toml"]
    once = run("import", "sweep.csv", "--model", "arm.xml", "-o", "alone.toml", "-q", cwd=imported)
    assert once.returncode == 0
    alone, together = (
        tomllib.loads((imported / name).read_text()) for name in ("alone.toml", "data/sweep.toml")
    )
    assert {**alone, "table": "", "name": ""} == {**together, "table": "", "name": ""}


def test_a_pattern_that_the_shell_left_alone_names_logs(imported: Path) -> None:
    done = run("import", "*.csv", "--model", "arm.xml", "-o", "quoted", "-q", cwd=imported)
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in (imported / "quoted").glob("*.toml")) == ["check.toml", "sweep.toml"]
    none = run("import", "*.xyz", "--model", "arm.xml", cwd=imported)
    assert none.returncode == 2 and "*.xyz" in none.stderr


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("sweep.csv", "check.csv", "-o", "one.toml"), "several logs do not go into one file"),
        (("sweep.csv", "sweep.csv", "-o", "new"), "two logs would have this one recording"),
        (("sweep.csv", "arm.xml"), "a mechanism is imported alone"),
        (("sweep.csv", "check.csv", "--json", "x.json"), "--json is of one log"),
        (("sweep.csv", "check.csv", "-o", "data"), "the file exists"),
    ],
)
def test_what_cannot_be_imported_together_is_refused(
    imported: Path, words: tuple[str, ...], says: str
) -> None:
    ended = run("import", *words, "--model", "arm.xml", cwd=imported)
    assert ended.returncode == 2 and says in " ".join(ended.stderr.split())
    assert not (imported / "new").exists()


def test_one_log_that_cannot_be_read_leaves_none_imported(imported: Path) -> None:
    """The first is written as a TOML file, the second with a table of its own, the third is no table."""
    (imported / "bad.csv").write_text("t,q\n0,nothing\n")
    shutil.copy(imported / "check.csv", imported / "semicolons.csv")
    text = (imported / "check.csv").read_text().replace(",", ";")
    (imported / "semicolons.csv").write_text(text)
    before = sorted(imported.rglob("*"))
    logs = "sweep.csv", "semicolons.csv", "bad.csv"
    for place in (("-o", "fresh"), ()):
        ended = run("import", *logs, "--model", "arm.xml", *place, cwd=imported)
        assert ended.returncode == 2 and "bad.csv" in ended.stderr, ended.stderr
        assert "Wrote" not in ended.stdout and sorted(imported.rglob("*")) == before


def test_models_among_recordings_are_left_out_with_a_note(imported: Path) -> None:
    write_model(load_model(imported / "arm.xml"), imported / "data" / "better.toml", force=True)
    ended = run("inspect", "data/better.toml", "data/check.toml", "data/sweep.toml", cwd=imported)
    assert ended.returncode == 0 and "note: data/better.toml is a model" in ended.stderr
    quoted = run("inspect", "data/*.toml", cwd=imported)
    assert quoted.returncode == 0 and "note: data/better.toml" in quoted.stderr
    alone = run("inspect", "data/better.toml", cwd=imported)
    assert alone.returncode == 2 and "is not a recording" in alone.stderr
    assert [r.name for r in load_recordings(str(imported / "data" / "*.toml"))] == ["check", "sweep"]
    with pytest.raises(InputError, match="is not a recording"):
        load_recordings(str(imported / "data" / "bet*.toml"))


def test_a_model_names_its_files_from_where_it_lies(imported: Path, tmp_path: Path) -> None:
    write_model(load_model(imported / "arm.xml"), imported / "data" / "far.toml")
    assert tomllib.loads((imported / "data" / "far.toml").read_text())["serial"] == "../arm.xml"
    shutil.copytree(imported, tmp_path / "moved")
    moved = load_model(tmp_path / "moved" / "data" / "far.toml")
    assert moved.serial == (tmp_path / "moved" / "arm.xml").resolve()
    write_model(load_model("leg"), tmp_path / "leg2.toml")
    serial = tomllib.loads((tmp_path / "leg2.toml").read_text())["serial"]
    assert (models_folder() / serial).is_file() and ".." not in serial
