"""Files read in a separate process, because their readers may crash."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workbench.core import InputError
from workbench.core.bounds import MOST_BYTES, too_large

from . import apart_program as program

if TYPE_CHECKING:
    import can

SILENCE_S = 60.0  # of CPU time without a word: a file whose blocks refer to each other has no end


def mf4_messages(path: Path) -> Generator[can.Message]:
    """Return the data frames of an MF4 log by time.

    Raises:
        NotImplementedError: asammdf, which reads them, is not installed.
        MemoryError: more memory is needed than there may be.
        ValueError: the file cannot be read, or whoever read it crashed or came to no end.
    """
    import can

    for part in _read("mf4", path):
        for time, number, extended, channel, length, data in program.FRAME.iter_unpack(part):
            yield can.Message(
                timestamp=time,
                arbitration_id=number,
                is_extended_id=extended,
                channel=None if channel < 0 else channel,
                data=data[:length],
            )


def matlab_arrays(path: Path, names: Sequence[str] = ()) -> dict[str, np.ndarray | None]:
    """Return arrays of a MATLAB file up to version 7 by name (``struct.field``); None if not numbers.

    Args:
        path: the file.
        names: variables to read, all if left out. Where one is missing, the file's own names come as well.

    Raises:
        InputError: it is of version 7.3, damaged, or larger than a table may be.
    """
    found: dict[str, np.ndarray | None] = {}
    size = 0
    try:
        for part in _read("matlab", path, *names):
            name, _, array = part.partition(b"\0")
            size += len(array)
            if size > MOST_BYTES:
                raise too_large(path)
            found[name.decode()] = np.load(io.BytesIO(array), allow_pickle=False) if array else None
    except NotImplementedError as error:
        remedy = "save it again in MATLAB with save(..., '-v7')"
        raise InputError("MATLAB 7.3 files are not read", file=path, remedy=remedy) from error
    except ValueError as error:
        remedy = "check that the file is whole"
        raise InputError("is not a readable MATLAB file", file=path, remedy=remedy) from error
    return found


def _read(kind: str, path: Path, *words: str) -> Generator[bytes]:
    """Return what the program read from a file, under the memory limit of this process."""
    # it finds the packages that this process finds, wherever they are
    places = os.pathsep.join(each for each in sys.path if each)
    process = subprocess.Popen(
        [sys.executable, "-P", program.__file__, kind, str(path.resolve()), str(SILENCE_S), *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": places},
    )
    with process:
        stream = process.stdout
        assert stream is not None
        try:
            while len(head := stream.read(program.HEAD.size)) == program.HEAD.size:
                what, length = program.HEAD.unpack(head)
                part = stream.read(length)
                if what == program.END:
                    return
                if what == program.NO_READER:
                    raise NotImplementedError
                if what == program.TOO_LARGE:
                    raise MemoryError
                if what == program.UNREADABLE:
                    raise ValueError(part.decode("utf-8", "replace"))
                yield part
            raise ValueError(_ended(process.wait()))
        finally:
            process.kill()


def _ended(code: int) -> str:
    """Return why an unfinished process has ended."""
    if code == -signal.SIGPROF:
        return f"reading it does not end ({SILENCE_S:g} s without progress)"
    try:
        how = signal.Signals(-code).name
    except ValueError:
        how = f"exit code {code}"
    return f"the file is damaged: its reader crashed ({how})"
