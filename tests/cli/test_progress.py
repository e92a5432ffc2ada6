"""Somebody who reads a log later, or waits before a pipe, is told now and then; nobody else is disturbed."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

import workbench.cli.heartbeat as module
from workbench.cli import options
from workbench.cli.heartbeat import Heartbeat, duration, waiting
from workbench.cli.progress import progress, staged


class Clocked:
    """A heartbeat that beats each second of a clock that the test turns."""

    def __init__(self) -> None:
        self.now = 100.0
        self.lines: list[str] = []
        self.heart = Heartbeat("compare", say=self.lines.append, clock=lambda: self.now)

    def wait(self, seconds: int) -> None:
        for _ in range(seconds):
            self.now += 1.0
            self.heart.beat()


def test_a_line_after_20_s_then_each_half_minute() -> None:
    clocked = Clocked()
    clocked.wait(10)
    clocked.heart.tell("fitting a")
    clocked.wait(15)
    clocked.heart.tell("comparing rivals of b")
    clocked.wait(90)
    assert clocked.lines == [
        "after 20 s: fitting a",
        "after 50 s: comparing rivals of b",
        "after 1 min 20 s: still comparing rivals of b, 55 s",
        "after 1 min 50 s: still comparing rivals of b, 1 min 25 s",
    ]


def test_what_is_quick_says_nothing_nor_does_a_question() -> None:
    clocked = Clocked()
    clocked.wait(19)
    with clocked.heart.hushed():
        clocked.wait(300)
    clocked.wait(29)
    assert not clocked.lines
    clocked.wait(1)
    assert clocked.lines == ["after 5 min 49 s: compare"]


def _program(busy: Callable[[], object], told: bool, asked: bool = False) -> typer.Typer:
    """A command that computes for a while without a word to anybody."""
    program = typer.Typer()

    @program.command()
    def search(quiet: options.Quiet = False) -> None:
        with progress(quiet) as tell:
            if told:
                staged(tell)("fitting [bold]x[/bold]")
            if asked:
                with waiting():
                    busy()
            else:
                busy()
        typer.echo("result")

    @program.command()
    def other() -> None: ...

    return program


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What a heartbeat of every 20 ms says, and what a command prints."""
    said, echo = list[str](), typer.echo

    def heard(line: str, **options: Any) -> None:
        said.append(line)
        echo(line, **options)

    import rich.progress  # noqa: F401  what is loaded once is no part of the waiting

    monkeypatch.setattr(module, "FIRST_S", 0.02)
    monkeypatch.setattr(module, "EVERY_S", 0.02)
    monkeypatch.setattr(typer, "echo", heard)
    return said


def _until(done: Callable[[], bool]) -> Callable[[], None]:
    """To be busy until something was said, however slow this machine is."""

    def busy() -> None:
        end = time.monotonic() + 60.0
        while not done() and time.monotonic() < end:
            time.sleep(0.01)

    return busy


def test_every_command_has_it_on_the_error_stream_alone(said: list[str]) -> None:
    found = CliRunner().invoke(
        _program(_until(lambda: any("still fitting" in x for x in said)), True), ["search"]
    )
    assert found.stdout == "result\n"
    lines = [re.sub(r"\d+ s", "# s", line) for line in found.stderr.splitlines()]
    told = [line for line in lines if not line.endswith("search")]
    assert told[0] == "after # s: fitting [bold]x[/bold]"
    assert set(told[1:]) == {"after # s: still fitting [bold]x[/bold], # s"}


def test_what_tells_nothing_is_called_by_its_command(said: list[str]) -> None:
    found = CliRunner().invoke(_program(_until(lambda: bool(said)), told=False), ["search"])
    assert re.fullmatch(r"after \d+ s: search", found.stderr.splitlines()[0])


@pytest.mark.parametrize(("words", "asked"), [("-q", False), ("", True)])
def test_quiet_or_asking_says_nothing(said: list[str], words: str, asked: bool) -> None:
    meanwhile = list[str]()

    def busy() -> None:
        before = len(said)
        time.sleep(0.4)
        meanwhile.extend(said[before:])

    found = CliRunner().invoke(_program(busy, told=True, asked=asked), ["search", *words.split()])
    printed = len(said)
    time.sleep(0.15)  # of a heartbeat that had outlived its command
    assert found.stdout == "result\n" and not meanwhile and said[printed:] == []
    assert words != "-q" or said == ["result"]


def test_a_command_that_was_refused_says_nothing_by_the_next() -> None:
    program = typer.Typer()

    @program.command()
    def search(count: int, quiet: options.Quiet = False) -> None:
        typer.echo(count)

    before = _beating()
    assert CliRunner().invoke(program, ["many"]).exit_code == 2
    assert CliRunner().invoke(program, ["3"]).stdout == "3\n"
    _until(lambda: _beating() <= before)()
    assert _beating() <= before


def _beating() -> int:
    return sum(thread.name == "heartbeat" for thread in threading.enumerate())


def test_what_is_quick_says_nothing_at_all() -> None:
    found = CliRunner().invoke(_program(lambda: None, told=True), ["search"])
    assert (found.stdout, found.stderr) == ("result\n", "")


def test_times_in_words() -> None:
    assert [duration(x) for x in (0.4, 59.0, 61.0, 3600.0)] == ["0 s", "59 s", "1 min 01 s", "60 min 00 s"]
