"""A block of code may take only so long."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager


class TooLong(BaseException):
    """The time is up; nothing that catches exceptions catches it by mistake."""


@contextmanager
def at_most(seconds: float, *, cpu: bool = False) -> Iterator[None]:
    """Stop what is inside once its time is up; only a process's main thread can.

    Args:
        seconds: that it may take [s].
        cpu: count the time that this process computes, whatever else the machine does; else the clock's.

    Raises:
        TooLong: it took longer.
    """

    def ring(*_: object) -> None:
        raise TooLong(f"took more than {seconds:g} s")

    alarm, timer = (signal.SIGPROF, signal.ITIMER_PROF) if cpu else (signal.SIGALRM, signal.ITIMER_REAL)
    before = signal.signal(alarm, ring)
    signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        signal.setitimer(timer, 0.0)
        signal.signal(alarm, before)
