"""MF4 logs, read in a process of their own: what reads them can crash, and must not take this one along."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING

from . import mf4_apart as apart

if TYPE_CHECKING:
    import can

SILENCE_S = 60.0  # of CPU time without a frame: a file whose blocks refer to each other has no end
_LONGEST = 4000  # bytes of an error's text that are read


def mf4_messages(path: Path) -> Generator[can.Message]:
    """The data frames of an MF4 log by time; the limit on memory that holds here holds there too.

    Raises:
        NotImplementedError: asammdf, which reads them, is not installed.
        MemoryError: more memory is needed than there may be.
        ValueError: the file cannot be read, or whoever read it crashed or came to no end.
    """
    import can

    # it finds the packages that this process finds, wherever they are
    places = os.pathsep.join(each for each in sys.path if each)
    process = subprocess.Popen(
        [sys.executable, "-P", apart.__file__, str(path.resolve()), str(SILENCE_S)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": places},
    )
    with process:
        stream = process.stdout
        assert stream is not None
        try:
            while True:
                record = stream.read(apart.RECORD.size)
                if len(record) < apart.RECORD.size:
                    raise ValueError(_ended(process.wait()))
                kind, time, number, extended, channel, length, data = apart.RECORD.unpack(record)
                if kind != apart.FRAME:
                    break
                yield can.Message(
                    timestamp=time,
                    arbitration_id=number,
                    is_extended_id=extended,
                    channel=None if channel < 0 else channel,
                    data=data[:length],
                )
            if kind == apart.NO_READER:
                raise NotImplementedError
            if kind == apart.TOO_LARGE:
                raise MemoryError
            if kind == apart.UNREADABLE:
                raise ValueError(stream.read(_LONGEST).decode("utf-8", "replace"))
        finally:
            process.kill()


def _ended(code: int) -> str:
    """Why a process that was not done has ended."""
    if code == -signal.SIGPROF:
        return f"reading it comes to no end ({SILENCE_S:g} s without a frame)"
    try:
        how = signal.Signals(-code).name
    except ValueError:
        how = f"exit code {code}"
    return f"it is damaged so that what reads MF4 crashed ({how})"
