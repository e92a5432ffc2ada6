"""A log of all frames of a run: from virtual buses, or by a separate process that survives this one."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from workbench.can import CanConfig, Frame, Wire
from workbench.can.candump import line
from workbench.core.files import write_whole

from .host import Host
from .ports import refuse_unheard
from .processes import end, start
from .stopping import RunError


class WireLog:
    """Frames of virtual buses in simulated time, written at the end.

    Args:
        wires: by name.
        log: the file.
    """

    def __init__(self, wires: Mapping[str, Wire], log: Path) -> None:
        self._lines: list[str] = []
        self._log = log
        for name, wire in wires.items():
            wire.attach("logger", partial(self._heard, name))

    def _heard(self, name: str, stamp: float, frame: Frame) -> None:
        self._lines.append(line(stamp, name, frame))

    def watch(self, host: Host) -> None:
        """Do nothing: this log cannot fail."""

    def close(self) -> float:
        """Write the file; return the offset of its stamps from those of the loop: 0 s."""
        write_whole(self._log, "".join(self._lines))
        return 0.0


class ProcessLog:
    """Frames of buses, logged by another process.

    Args:
        config: whose buses.
        log: the file; beside it stands ``.clock``.

    Raises:
        InputError: a bus that no other process can hear.
    """

    def __init__(self, config: CanConfig, log: Path) -> None:
        refuse_unheard(config)
        self._log = log
        self._process = start("can", "log", str(config.source), "-o", str(log), "--parent", str(os.getpid()))

    def watch(self, host: Host) -> None:
        """Stop the host if frames are no longer logged."""
        host.operator.watches.append(
            lambda: "the end of the logger" if self._process.poll() is not None else None
        )

    @property
    def shift(self) -> float:
        """Return wall clock minus monotonic time in the stamps of the log [s]; known once it is ready."""
        return float(json.loads(self._log.with_suffix(".clock").read_text().splitlines()[0])["shift"])

    def close(self) -> float:
        """End the process; return its stamps minus those of the loop [s].

        Raises:
            RunError: it failed.
        """
        said = end(self._process)
        if self._process.returncode != 0:
            why = said or self._process.returncode
            raise RunError(f"{self._log}: the logger failed, and the log is incomplete: {why}")
        return self.shift
