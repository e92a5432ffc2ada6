"""Somebody who reads a log later, or waits before a pipe, is told now and then; nobody else is disturbed."""

from __future__ import annotations

import pytest

import workbench.cli.progress as module
from workbench.cli.progress import duration, progress, staged


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_a_line_every_half_minute_outside_a_terminal(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    with progress(quiet=False) as tell:
        told = staged(tell)
        for text, later in (("fitting a", 5.0), ("fitting b", 26.0), ("fitting c", 20.0), ("found d", 40.0)):
            clock[0] += later
            told(text)
    shown = capsys.readouterr()
    assert shown.err.splitlines() == ["after 31 s: fitting b", "after 1 min 31 s: found d"]
    assert not shown.out


def test_what_is_quick_or_quiet_says_nothing(clock: list[float], capsys: pytest.CaptureFixture[str]) -> None:
    with progress(quiet=False) as tell:
        tell("fitting", 0.5)
    with progress(quiet=True) as tell:
        clock[0] += 1000.0
        tell("fitting", 0.5)
    assert capsys.readouterr() == ("", "")


def test_times_in_words() -> None:
    assert [duration(x) for x in (0.4, 59.0, 61.0, 3600.0)] == ["0 s", "59 s", "1 min 01 s", "60 min 00 s"]
