"""What all commands have alike: JSON, silence, and nothing overwritten."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from tests.can.make import config, motor
from workbench.cli.app import app
from workbench.core import InputError
from workbench.core.version import VERSION

# they run until they are interrupted, or write a file that is itself for programs
_OTHERS = {"ui", "show", "can bus", "can motors", "can virtual", "can log"}


def commands(command: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Every command of a group, by the words that call it."""
    inner = getattr(command, "commands", None)
    if inner is None:
        yield name, command
    else:
        for each, below in inner.items():
            yield from commands(below, f"{name} {each}".strip())


def options(command: Any) -> set[str]:
    return {option for each in command.params for option in each.opts}


def test_results_come_as_json_in_silence_and_by_force() -> None:
    found = dict(commands(typer.main.get_command(app)))
    assert set(found) > _OTHERS
    for name, command in found.items():
        if name not in _OTHERS:
            assert options(command) >= {"--json", "--quiet", "-q", "--force"}, name


def run(*words: object) -> Any:
    """The command line, in this process: what counts is what stands where."""
    return CliRunner().invoke(app, [str(word) for word in words])


def test_help_of_every_command_has_an_example_and_fits() -> None:
    names = [name for name, _ in commands(typer.main.get_command(app))]
    listing = run("--help").stdout
    assert "..." not in listing.replace("[ARGS]...", "") and "Start with: workbench demo" in listing
    for name in names:
        said = run(*name.split(), "--help").stdout
        assert "Example: workbench" in said, name
        assert max(map(len, said.splitlines())) <= 80, name
        assert f"\n  {name.split()[0]} " in listing


def test_the_program_says_its_version() -> None:
    version = f"workbench {VERSION}\n"
    assert run("--version").stdout == version
    module = [sys.executable, "-m", "workbench", "--version"]
    assert subprocess.run(module, capture_output=True, text=True, check=True).stdout == version


@pytest.fixture
def sdf(tmp_path: Path) -> Path:
    """A pendulum."""
    file = tmp_path / "pendulum.sdf"
    file.write_text("""<sdf version="1.9"><model name="pendulum"><link name="rod"><pose>0 0 -0.1 0 0 0</pose>
    <inertial><mass>1</mass></inertial></link><joint name="pin" type="revolute"><parent>world</parent>
    <child>rod</child><axis><xyz>0 1 0</xyz></axis></joint></model></sdf>""")
    return file


@pytest.mark.parametrize("case", ["add", "import", "can load"])
def test_json_on_standard_output_stands_there_alone(case: str, tmp_path: Path, sdf: Path) -> None:
    robot = config(tmp_path, [motor("motor", 1)]).source
    words = {
        "add": ("add", "leg", "torque_bias@hip", "torque=0.1", "--force", "-o", tmp_path / "m.toml"),
        "import": ("import", sdf),
        "can load": ("can", "load", robot),
    }[case]
    told, quiet = tmp_path / "told.json", tmp_path / "quiet.json"
    said = run(*words)
    assert said.exit_code == 0 and said.stdout, said.stderr
    alone = run(*words, "--json", "-")
    assert json.loads(alone.stdout)["format"] == 1
    both = run(*words, "--json", told)
    assert both.stdout == said.stdout
    assert json.loads(told.read_text()) == json.loads(alone.stdout)
    assert run(*words, "--quiet", "--json", quiet).stdout == ""
    assert quiet.read_bytes() == told.read_bytes()
    if case != "add":
        again = run(*words, "--json", told)
        assert isinstance(again.exception, InputError) and "--force" in str(again.exception)


@pytest.mark.parametrize(
    "words",
    [
        ("add", "leg", "torque_bias@hip", "torque=0.1"),
        ("improve", "leg", "recording.toml"),
        ("identify", "leg", "sum.toml", "difference.toml"),
        ("identify", "actuator", "chirp.toml"),
    ],
    ids=lambda words: " ".join(words[:2]),
)
def test_a_model_is_written_under_a_name_that_can_be_read(words, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = run(*words, "-o", "better.xml")
    assert isinstance(done.exception, InputError) and "call it .toml" in str(done.exception)
    assert not list(tmp_path.iterdir())
