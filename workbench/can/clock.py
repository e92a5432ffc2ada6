"""The common clock of a robot: monotonic time, which can run slower with virtual hardware."""

from __future__ import annotations

import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Clock:
    """Monotonic time over `scale`: every process with the same scale reads the same clock.

    Buses, drives, watchdogs and the loop all take their time from here, so that nothing between them changes
    when it runs slower; only the operating system's own delays become shorter against it.

    Attributes:
        scale: seconds of the machine to one of the bench.
    """

    scale: float = 1.0

    def now(self) -> float:
        """Return the time of the bench [s]."""
        return time.monotonic() / self.scale

    def machine(self, seconds: float) -> float:
        """Return the time [s] that the computer has to sleep or wait for a duration on the bench."""
        return seconds * self.scale

    def sleep_until(self, when: float) -> None:
        """Return at `when` [s], or immediately if that is past."""
        wait = self.machine(when - self.now())
        if wait > 0.0:
            time.sleep(wait)
