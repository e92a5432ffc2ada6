"""What takes too long ends, by the clock or by what it computes."""

from __future__ import annotations

import signal
import time

import pytest
from limits import TooLong, at_most


def test_who_waits_computes_nothing() -> None:
    before = signal.getsignal(signal.SIGALRM)
    with at_most(0.05, cpu=True):
        time.sleep(0.1)
    with pytest.raises(TooLong, match=r"more than 0\.02 s"), at_most(0.02):
        time.sleep(10.0)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) is before


def test_what_computes_on_ends_though_it_catches_exceptions() -> None:
    begun = time.process_time()
    with pytest.raises(TooLong), at_most(0.05, cpu=True):
        while time.process_time() - begun < 10.0:
            try:
                sum(range(1000))
            except Exception:
                continue
