"""Commands that run until they are interrupted: they say that they are there, and end without a word more."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import tomli_w

from tests.can.make import motor, table
from tests.cli.here import run
from tests.cli.test_matrix import ELSEWHERE, TREE

#: What each is asked; the robot has a bus of its own.
WORDS = {
    "ui": ["ui", "leg", "--no-browser"],
    "can bus": ["can", "bus", "robot.toml"],
    "can motors": ["can", "motors", "robot.toml"],
    "can virtual": ["can", "virtual", "robot.toml"],
    "can log": ["can", "log", "robot.toml", "-o", "today.log"],
}
NEEDS_BUS = {"can motors", "can log"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    content = table([motor("lift", 1), motor("bend", 2)])
    content["bus"][0]["channel"] = str(tmp_path / "can0")
    (tmp_path / "robot.toml").write_text(tomli_w.dumps(content))
    return tmp_path


def started(words: list[str], folder: Path) -> subprocess.Popen[str]:
    """The command, once it has said its first line."""
    process = subprocess.Popen(
        [sys.executable, "-m", "workbench.cli", *words],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    said = process.stdout.readline()
    assert said.startswith(("ready", "The workbench is at http://")), (said, process.communicate())
    return process


def test_all_that_run_until_they_are_interrupted_are_here() -> None:
    assert set(WORDS) == ELSEWHERE == {name for name in TREE if name in ELSEWHERE}


@pytest.mark.parametrize("name", WORDS)
def test_an_interrupt_ends_it_without_a_traceback(name: str, folder: Path) -> None:
    bus = started(WORDS["can bus"], folder) if name in NEEDS_BUS else None
    try:
        process = started(WORDS[name], folder)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
        assert process.returncode in (0, 130) and err.strip() == "", err
    finally:
        if bus is not None:
            bus.send_signal(signal.SIGINT)
            bus.communicate(timeout=30)


@pytest.mark.parametrize("name", sorted(NEEDS_BUS))
def test_without_a_bus_it_is_refused_in_one_line(name: str, folder: Path) -> None:
    done = run(*WORDS[name], cwd=folder)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert done.stderr.startswith("error: ") and "start it with" in done.stderr


def test_a_log_that_exists_is_written_over_only_by_force(folder: Path) -> None:
    (folder / "today.log").write_text("kept")
    bus = started(WORDS["can bus"], folder)
    try:
        done = run(*WORDS["can log"], cwd=folder)
        assert (
            done.returncode == 2 and "--force" in done.stderr and (folder / "today.log").read_text() == "kept"
        )
        forced = started([*WORDS["can log"], "--force"], folder)
        forced.send_signal(signal.SIGINT)
        assert forced.wait(timeout=30) == 0 and (folder / "today.log").read_text() == ""
    finally:
        bus.send_signal(signal.SIGINT)
        bus.communicate(timeout=30)


def test_virtual_hardware_says_what_it_is_and_that_it_ended(folder: Path) -> None:
    content = table(
        [motor("hip", 1), motor("knee", 2)], mechanism=[{"model": "four_bar", "axes": ["hip", "knee"]}]
    )
    content["bus"][0]["channel"] = str(folder / "can0")
    (folder / "robot.toml").write_text(tomli_w.dumps(content))
    process = started(WORDS["can virtual"], folder)
    listed = subprocess.run(
        ["ps", "-o", "pid=,args=", "--ppid", str(process.pid)], capture_output=True, text=True
    )
    [motors] = [line.split()[0] for line in listed.stdout.splitlines() if "can motors" in line]
    os.kill(int(motors), signal.SIGKILL)
    _, err = process.communicate(timeout=30)
    first, last = err.strip().splitlines()
    assert first.startswith("Virtual hardware of four_bar: "), err
    assert process.returncode == 1 and "ended by itself" in last, err
