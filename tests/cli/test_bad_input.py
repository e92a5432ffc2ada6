"""Every argument of every command given what it cannot read: one line, exit code 2, and nothing written."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.cli.here import run
from tests.cli.test_matrix import ARGUMENTS, SUFFIX, TREE, asked_of, files, fine, outputs

__all__ = ["files"]  # a fixture

#: What files are of no use to any command.
BAD = {
    "empty": b"",
    "words": b"nothing of use\n",
    "bytes": bytes(range(256)),
    "page": b"<html><body>404 not found</body></html>\n",
    "other": b'{"format": 1}\n',
}
#: By what ending an argument is told from others; a file for each is tried.
ENDINGS = {
    "model": (".toml", ".xml", ".urdf"),
    "bundle": (".zip",),
    "run": ("",),
    "file": (".csv", ".json", ".xml"),
}
#: Words of arguments that are no files, and that commands cannot do without.
WORDS = {"rig": "leg", "task": "reach", "output": "arm.toml"}
CASES = [
    (name, k)
    for name, command in TREE.items()
    for k, _ in enumerate(p for p in command.params if p.param_type_name == "argument")
]


def names(folder: Path, argument: str) -> list[Path]:
    """Paths that are no use: files, one that is not there, and a folder."""
    endings = ENDINGS.get(argument, (".toml",))
    for ending in endings:
        (folder / f"folder{ending}").mkdir(parents=True, exist_ok=True)
        for name, content in BAD.items():
            (folder / f"{name}{ending}").write_bytes(content)
    too_long = 300 * "a"  # for a file's name
    there = [] if argument == "output" else ["gone", "folder", too_long]  # where something is to be written
    return [folder / f"{name}{ending}" for ending in endings for name in (*there, *BAD)]


def asked(name: str, arguments: list[str], files: dict[str, Path]) -> list[Any]:
    """Words by which a command would run; those of its arguments come first."""
    try:
        words = asked_of(name, TREE[name])[0]
    except AssertionError:
        words = []
    words = words or [WORDS.get(a) or ARGUMENTS.get(a, "arm.xml") for a in arguments]
    return [files.get(str(word), word) for word in words]


@pytest.mark.parametrize(("name", "k"), CASES, ids=[f"{n} {k}" for n, k in CASES])
def test_what_cannot_be_read_ends_in_one_line(
    name: str, k: int, files: dict[str, Path], tmp_path: Path
) -> None:
    arguments = [p.name for p in TREE[name].params if p.param_type_name == "argument"]
    words = asked(name, arguments, files)
    made = outputs(TREE[name], tmp_path / "out", SUFFIX.get(name, ".toml"))
    for path in names(tmp_path / "in", arguments[k]):
        given = [
            *name.split(),
            *words[:k],
            path,
            *words[k + 1 :],
            *(w for pair in made.items() for w in pair),
        ]
        ended = run(*given, cwd=tmp_path)
        assert not fine(ended, given), (given, ended.stdout)
        assert not (tmp_path / "out").exists(), (given, "something was written all the same")


def test_a_name_that_no_file_can_have_is_refused_at_once(files: dict[str, Path], tmp_path: Path) -> None:
    given = ["compare", files["arm.xml"], files["arm.toml"], "--html", 300 * "a" + ".html"]
    ended = run(*given, cwd=tmp_path)
    assert not fine(ended, given) and "File name too long" in ended.stderr, ended.stderr
    assert ended.stdout == ""


@pytest.mark.parametrize("name", [n for n, c in TREE.items() if outputs(c, Path("x"), ".toml")])
def test_an_output_two_new_folders_deep_is_a_typing_error(
    name: str, files: dict[str, Path], tmp_path: Path
) -> None:
    """One new folder is made for an output, not a chain of them."""
    arguments = [p.name for p in TREE[name].params if p.param_type_name == "argument"]
    words = [*name.split(), *asked(name, arguments, files)]
    for option, file in outputs(TREE[name], Path("gone/below"), SUFFIX.get(name, ".toml")).items():
        ended = run(*words, option, file, cwd=tmp_path)
        assert not fine(ended, [*words, option]) and "there is no folder 'gone'" in ended.stderr, ended.stderr
        assert ended.stdout == "" and not (tmp_path / "gone").exists()


@pytest.mark.parametrize("option", ["--html", "--json", "--mcap"])
@pytest.mark.parametrize("command", ["compare", "diagnose"])
def test_no_result_takes_the_place_of_an_input(
    command: str, option: str, files: dict[str, Path], tmp_path: Path
) -> None:
    """Not even by force: what was measured cannot be measured again."""
    for name in ("arm.toml", "arm.csv", "arm.xml"):
        shutil.copy(files[name], tmp_path)
    for name in ("arm.toml", "arm.csv", "arm.xml"):
        before = (tmp_path / name).read_bytes()
        given = [command, "arm.xml", "arm.toml", option, name, "--force"]
        ended = run(*given, cwd=tmp_path)
        assert not fine(ended, given) and "input of this command" in ended.stderr, ended.stderr
        assert ended.stdout == "" and (tmp_path / name).read_bytes() == before


def test_the_improved_model_takes_no_recording_s_place(files: dict[str, Path], tmp_path: Path) -> None:
    for name in ("arm.toml", "arm.csv", "arm.xml"):
        shutil.copy(files[name], tmp_path)
    given = ["improve", "arm.xml", "arm.toml", "-o", "arm.toml", "--force"]
    ended = run(*given, cwd=tmp_path)
    assert not fine(ended, given) and "input of this command" in ended.stderr, ended.stderr
    assert "table" in (tmp_path / "arm.toml").read_text()
