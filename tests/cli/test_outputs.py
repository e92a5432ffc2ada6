"""Outputs that cannot be written are refused before any work; what was written is said once it is there."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
import typer

import workbench.cli
from tests.cli.here import run
from tests.cli.test_matrix import SUFFIX, TREE, asked_of, fine, outputs
from tests.disk import Disk
from workbench.cli.common import check_outputs, whole, wrote
from workbench.core import InputError
from workbench.core.files import write_whole

WRITERS = [name for name, command in TREE.items() if outputs(command, Path("x"), ".toml")]


def words_of(name: str) -> list[object]:
    """A call that would be refused for its inputs, none of which is there."""
    try:
        return [*name.split(), *asked_of(name, TREE[name])[0]]
    except AssertionError:
        return [*name.split(), *("gone" for p in TREE[name].params if p.param_type_name == "argument")]


@pytest.mark.parametrize("name", WRITERS)
def test_a_folder_that_cannot_be_written_comes_first(name: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for option, path in outputs(TREE[name], Path("file"), SUFFIX.get(name, ".toml")).items():
        words = [*words_of(name), option, path]
        ended = run(*words, cwd=tmp_path)
        assert not fine(ended, words) and f"{path}: cannot write: " in ended.stderr, ended.stderr
        assert "is a file, not a folder" in ended.stderr and ended.stdout == ""
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["frf", "gone", "gone.toml", "--figure", "x.gif"], ".png, .svg or .pdf"),
        (["identify", "actuator", "gone.toml", "--figure", "x.gif"], ".png, .svg or .pdf"),
        (["identify", "leg", "gone.toml", "--figure", "x"], ".png, .svg or .pdf"),
        (["identify", "links", "gone", "gone.toml", "--figure", "x.jpg"], ".png, .svg or .pdf"),
        (["diagnose", "gone", "gone.toml", "--shape", "x.gif"], ".png, .svg or .pdf"),
        (["show", "gone.toml", "-o", "x.html", "--mp4", "x.gif"], "name it .mp4"),
        (["excite", "gone", "-o", "x.json"], "does not end in .toml"),
        (["import", "gone.csv", "-o", "x.csv"], "does not end in .toml"),
        (["export", "gone", "-o", "x.tar"], "does not end in .zip"),
        (["compare", "gone", "gone.toml", "--json", "x", "--html", "./x"], "two outputs have this name"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_a_name_that_cannot_be_comes_first(words: list[object], said: str, tmp_path: Path) -> None:
    ended = run(*words, cwd=tmp_path)
    assert not fine(ended, words) and said in ended.stderr, ended.stderr
    assert ended.stdout == "" and not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", ["a.json", "new/a.json"])
def test_a_folder_is_tried_and_nothing_is_left(path: str, tmp_path: Path) -> None:
    check_outputs(str(tmp_path / path), "-", None, force=False)
    with Disk(1, tmp_path), pytest.raises(InputError, match=r"a\.json: cannot write: No space left"):
        check_outputs(str(tmp_path / path), force=False)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ending", [None, typer.Exit(1), InputError("wrong")])
def test_files_are_told_once_they_are_there(
    ending: Exception | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def command() -> None:
        write_whole(tmp_path / "a.json", "1")
        wrote("Wrote a.json.")
        assert not capsys.readouterr().out
        if ending is not None:
            raise ending

    try:
        whole(command)()
    except (InputError, typer.Exit) as error:
        assert error is ending
    there = (tmp_path / "a.json").exists()
    assert there is not isinstance(ending, InputError)
    assert capsys.readouterr().out == ("Wrote a.json.\n" if there else "")


def test_outside_of_a_whole_command_it_is_told_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    wrote("Wrote a.json.")
    assert capsys.readouterr().out == "Wrote a.json.\n"


def test_no_command_says_so_itself() -> None:
    said = []
    for file in Path(*workbench.cli.__path__).glob("*.py"):
        for call in ast.walk(ast.parse(file.read_text())):
            by = call.func if isinstance(call, ast.Call) else None
            name = getattr(by, "id", None) or getattr(by, "attr", None)
            if isinstance(call, ast.Call) and name in ("echo", "print", "say"):
                texts = [c.value for c in ast.walk(call) if isinstance(c, ast.Constant)]
                said += [(file.name, t) for t in texts if isinstance(t, str) and "rote " in t]
    assert not said
