"""A program of its own that writes what an MF4 log or a MATLAB file holds, in pieces, to its output.

What reads them (asammdf, scipy) is compiled in part, and a damaged file can crash it. So it runs in a process
of its own, which knows nothing of workbench and starts quickly; `apart` starts it and reads what it says.
"""

from __future__ import annotations

import io
import os
import signal
import struct
import sys
from collections.abc import Iterator, Sequence
from typing import Any

HEAD = struct.Struct("<cQ")  # what follows, and how many bytes of it
PART, END, UNREADABLE, TOO_LARGE, NO_READER = b"p", b".", b"e", b"m", b"n"
FRAME = struct.Struct("<dI?qB64s")  # time [s], identifier, extended or not, channel (-1: none), length, data
_OFTEN = 1000  # frames
_DEEPEST = 20  # structs in one another
_LONGEST = 4000  # letters of an error's text


def frames(path: str, _: Sequence[str]) -> Iterator[bytes]:
    """Yield the data frames of an MF4 log, some at a time."""
    import can

    _leave_formulas_alone()
    part = bytearray()
    with can.LogReader(path) as reader:
        for k, message in enumerate(reader):
            if k % _OFTEN == 0:
                yield bytes(part)
                part.clear()
            if message.is_error_frame or message.is_remote_frame:
                continue
            data, channel = bytes(message.data), message.channel
            if len(data) > 64:
                raise ValueError(f"a frame of {len(data)} bytes")
            where = channel if isinstance(channel, int) else -1
            head = message.timestamp, message.arbitration_id, message.is_extended_id
            part += FRAME.pack(*head, where, len(data), data)
    yield bytes(part)


def arrays(path: str, names: Sequence[str]) -> Iterator[bytes]:
    """Yield name and array of each variable and struct field; only the name if it is no array of numbers."""
    from scipy.io import loadmat, whosmat
    from scipy.io.matlab import matfile_version

    if matfile_version(path)[0] == 1:
        _check_ends(path)
    data = loadmat(path, variable_names=names or None, struct_as_record=False, chars_as_strings=False)
    for name, value in data.items():
        if not name.startswith("__"):
            yield from _walk(name, value, 0)
    if set(names) - set(data):
        yield from (f"{name}\0".encode() for name, _, _ in whosmat(path) if name not in data)


def _check_ends(path: str) -> None:
    """Check that every variable ends within the file; scipy would read a cut one without complaint.

    Source: MathWorks, "MAT-File Format", chapter 1 (version 5).
    """
    with open(path, "rb") as file:
        head = file.read(128)
        order, size = "<" if head[126:] == b"IM" else ">", os.fstat(file.fileno()).st_size
        while tag := file.read(8):
            if file.seek(struct.unpack(f"{order}II", tag)[1], os.SEEK_CUR) > size:
                raise ValueError("a variable extends past the end of the file")


def _walk(name: str, value: Any, depth: int) -> Iterator[bytes]:
    import numpy as np

    if isinstance(value, np.ndarray) and value.dtype == object and value.size == 1:
        value = value.flat[0]
    if hasattr(value, "_fieldnames") and depth < _DEEPEST:
        for field in value._fieldnames:
            yield from _walk(f"{name}.{field}", getattr(value, field), depth + 1)
        return
    out = io.BytesIO()
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf" and value.ndim <= 2:
        np.save(out, value, allow_pickle=False)
    yield f"{name}\0".encode() + out.getvalue()


def _leave_formulas_alone() -> None:
    """Refuse channels that a formula converts, because asammdf passes its text to `eval`."""
    try:
        from asammdf.blocks import v2_v3_blocks, v4_blocks
    except ImportError as error:
        raise NotImplementedError from error

    def not_compiled(*_: object, **__: object) -> None:
        raise TypeError  # what asammdf takes as a sign to use numpy, where the formula is its own

    def refused(*_: object, **__: object) -> None:
        raise ValueError("a channel is converted by a formula, which could be any code and is not run")

    for blocks in (v2_v3_blocks, v4_blocks):
        blocks.evaluate, blocks.lambdify, blocks.symbols = not_compiled, refused, str


def main() -> None:
    """Read the file named on the command line; messages of the libraries are discarded."""
    kind, path, silence, *words = sys.argv[1:]
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # which ends a process even in compiled code
    signal.setitimer(signal.ITIMER_PROF, float(silence))
    with os.fdopen(os.dup(1), "wb") as out:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        end, text = END, b""
        try:
            for part in {"mf4": frames, "matlab": arrays}[kind](path, words):
                signal.setitimer(signal.ITIMER_PROF, float(silence))
                out.write(HEAD.pack(PART, len(part)) + part)
        except NotImplementedError:
            end = NO_READER
        except MemoryError:
            end = TOO_LARGE
        except Exception as error:  # they raise whatever they met
            end, text = UNREADABLE, str(error)[:_LONGEST].encode("utf-8", "replace")
        out.write(HEAD.pack(end, len(text)) + text)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):  # who asked has gone
        os._exit(1)
