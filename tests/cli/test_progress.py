"""Somebody who reads a log later, or waits before a pipe, is told now and then; nobody else is disturbed."""

from __future__ import annotations

import time

import pytest
import typer
from typer.testing import CliRunner

import workbench.cli.heartbeat as module
from workbench.cli.common import QuietOption
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


def test_a_line_after_20_s_then_each_half_minute_and_where_it_stands_still() -> None:
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


def test_what_is_quick_says_nothing_and_nothing_is_written_into_a_question() -> None:
    clocked = Clocked()
    clocked.wait(19)
    with clocked.heart.hushed():
        clocked.wait(300)
    clocked.wait(29)
    assert not clocked.lines
    clocked.wait(1)
    assert clocked.lines == ["after 5 min 49 s: compare"]


def _program(seconds: float, told: bool, asked: bool = False) -> typer.Typer:
    """A command that computes for a while without a word to anybody."""
    program = typer.Typer()

    @program.command()
    def search(quiet: QuietOption = False) -> None:
        with progress(quiet) as tell:
            if told:
                staged(tell)("fitting [bold]x[/bold]")
            if asked:
                with waiting():
                    time.sleep(seconds)
            else:
                time.sleep(seconds)
        typer.echo("result")

    @program.command()
    def other() -> None: ...

    return program


@pytest.fixture
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    import rich.progress  # noqa: F401  what is loaded once is no part of the waiting

    monkeypatch.setattr(module, "FIRST_S", 0.15)
    monkeypatch.setattr(module, "EVERY_S", 0.2)


@pytest.mark.usefixtures("quickly")
def test_every_command_with_quiet_has_it_on_the_error_stream_alone() -> None:
    found = CliRunner().invoke(_program(0.45, told=True), ["search"])
    assert found.stdout == "result\n"
    first, second = found.stderr.splitlines()
    assert first == "after 0 s: fitting [bold]x[/bold]"
    assert second == "after 0 s: still fitting [bold]x[/bold], 0 s"
    untold = CliRunner().invoke(_program(0.3, told=False), ["search"])
    assert untold.stderr == "after 0 s: search\n"


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize(
    ("words", "seconds", "asked"), [("-q", 0.4, False), ("", 0.0, False), ("", 0.4, True)]
)
def test_quiet_quick_or_asking_says_nothing(words: str, seconds: float, asked: bool) -> None:
    found = CliRunner().invoke(_program(seconds, told=True, asked=asked), ["search", *words.split()])
    time.sleep(0.15)  # of a heartbeat that had outlived its command
    assert (found.stdout, found.stderr) == ("result\n", "")


def test_times_in_words() -> None:
    assert [duration(x) for x in (0.4, 59.0, 61.0, 3600.0)] == ["0 s", "59 s", "1 min 01 s", "60 min 00 s"]
