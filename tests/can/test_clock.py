"""One clock for every process of a bench, as slow as it is told to be."""

from __future__ import annotations

import time

import pytest

from workbench.can.clock import Clock


def test_processes_with_one_scale_read_one_clock() -> None:
    before, read, after = time.monotonic(), Clock(4.0).now(), time.monotonic()
    assert before <= 4.0 * read <= after


def test_it_sleeps_longer_and_never_for_what_is_past(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, slept = Clock(5.0), list[float]()
    monkeypatch.setattr(time, "monotonic", lambda: 100.0)
    monkeypatch.setattr(time, "sleep", slept.append)
    clock.sleep_until(clock.now() + 0.01)
    clock.sleep_until(clock.now() - 1.0)
    assert slept == [pytest.approx(0.05)]
    assert clock.machine(0.003) == pytest.approx(0.015)
