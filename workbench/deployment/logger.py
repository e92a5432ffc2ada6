"""Logs every frame on every bus, in a separate process that nobody waits for."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from pathlib import Path

from workbench.can import CanConfig
from workbench.can.candump import line
from workbench.core import InputError

from .ports import PortNetwork

_PAIR = 1.0  # s between pairs of clocks
_NAP = 0.05  # s


def log_buses(
    config: CanConfig,
    path: Path,
    stop: Callable[[], bool] = lambda: False,
    ready: Callable[[], None] = lambda: None,
) -> int:
    """Log until `stop` returns True; return the number of frames.

    Stamps are monotonic time plus one constant, so that they look like wall clock time and never jump. Beside
    the log stands ``.clock``: a pair of monotonic and wall clock time each second, and that constant.

    Args:
        config: the buses.
        path: of the log; must not exist.
        stop: asked now and then.
        ready: called when everything that comes is logged.

    Raises:
        InputError: the disk takes no more; what was written before stays, but for a last line cut off.
    """
    network, count = PortNetwork(config, echo=False), 0
    clock = config.clock
    shift = time.time() - clock.now()
    flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_EXCL
    log, clocks = os.open(path, flags, 0o644), os.open(path.with_suffix(".clock"), flags, 0o644)

    def pair(now: float) -> None:
        entry = {"monotonic": now, "wall": time.time(), "shift": shift}
        _whole(clocks, (json.dumps(entry) + "\n").encode(), path.with_suffix(".clock"))

    try:
        due = clock.now()
        pair(due)
        ready()
        while not (stop() or network.gone):
            now = clock.now()
            if now >= due + _PAIR:
                due = now
                pair(now)
            arrivals = network.receive(now + _NAP)
            # whole lines in one write: whoever is killed leaves whole lines
            _whole(log, "".join(line(a.stamp + shift, a.bus, a.frame) for a in arrivals).encode(), path)
            count += len(arrivals)
            time.sleep(2e-3)  # a few frames at a time; they wait in the socket
    finally:
        os.close(log)
        os.close(clocks)
        network.close()
    return count


def _whole(file: int, data: bytes, path: Path) -> None:
    """Writes all of it: a disk that is nearly full takes a part, and what came after would begin mid-line."""
    while data:
        try:
            data = data[os.write(file, data) :]
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(f"cannot be written ({reason})", file=path, remedy="free the disk") from error
