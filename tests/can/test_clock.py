"""One clock for every process of a bench, as slow as it is told to be."""

from __future__ import annotations

import time

import pytest

from workbench.can.clock import Clock


def test_processes_with_one_scale_read_one_clock() -> None:
    before, read, after = time.monotonic(), Clock(4.0).now(), time.monotonic()
    assert before <= 4.0 * read <= after


def test_it_sleeps_longer_and_never_for_what_is_past() -> None:
    clock, begin = Clock(5.0), time.monotonic()
    clock.sleep_until(clock.now() + 0.01)
    assert time.monotonic() - begin >= 0.05
    begin = time.monotonic()
    clock.sleep_until(clock.now() - 1.0)
    assert time.monotonic() - begin < 1.0
    assert clock.machine(0.003) == pytest.approx(0.015)
