"""Use of the processors by other programs, as the kernel counts it."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from pathlib import Path

from workbench.core.text import counted

PRESSURE = Path("/proc/pressure/cpu")
_MOST = 0.3  # of the time: three processes of a loop and its virtual drives wait for each other less


class Crowd:
    """Share of the time, from now on, in which some program waited for a processor.

    Args:
        pressure: the kernel's file (Linux 4.20); without one the load of the last minute is taken.
        clock: the time [s].
    """

    def __init__(self, pressure: Path = PRESSURE, clock: Callable[[], float] = time.monotonic) -> None:
        self._file, self._clock = pressure, clock
        self._begin, self._waited = clock(), _waited(pressure)

    def lacking(self) -> list[str]:
        """Return a line if other programs need the processors; otherwise none."""
        held = "a delay of a few milliseconds ends the run: stop other programs"
        waited, elapsed = _waited(self._file), self._clock() - self._begin
        if waited is not None and self._waited is not None:
            share = (waited - self._waited) / max(elapsed, 1e-3)
            if share <= _MOST:
                return []
            return [f"programs waited for a processor {100 * min(share, 1.0):.0f} % of the time, and {held}"]
        load, there = os.getloadavg()[0], os.cpu_count() or 1
        return [f"{load:.1f} programs want {counted(there, 'processor')}, and {held}"] if load > there else []


def _waited(file: Path) -> float | None:
    """For how long somebody has waited since the kernel began [s]; None where it does not count that."""
    try:
        found = re.search(r"^some .*total=(\d+)", file.read_text(), re.MULTILINE)
    except OSError:
        return None
    return 1e-6 * int(found[1]) if found else None
