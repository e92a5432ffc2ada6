"""Run as a program of its own: the data frames of an MF4 log, one record each, on standard output.

What reads MF4 (asammdf) is compiled in part, and a damaged file can crash it. So it runs in a process of its
own, which knows nothing of workbench and starts quickly; `mf4` starts it and reads what it says.
"""

from __future__ import annotations

import os
import signal
import struct
import sys
from typing import BinaryIO

#: What a record is, time [s], identifier, extended or not, channel (-1: none), length, data.
RECORD = struct.Struct("<cdI?qB64s")
FRAME, END, UNREADABLE, TOO_LARGE, NO_READER = b"f", b".", b"e", b"m", b"n"
_OFTEN = 1000  # frames


def send(path: str, silence: float, out: BinaryIO) -> None:
    """Write the data frames of a log, and last how it ended; an error's text follows that record.

    Ends the process where nothing is read for `silence` seconds of CPU time.
    """
    kind, text = END, ""
    try:
        import can

        _leave_formulas_alone()
        with can.LogReader(path) as reader:
            for k, message in enumerate(reader):
                if k % _OFTEN == 0:
                    signal.setitimer(signal.ITIMER_PROF, silence)
                if message.is_error_frame or message.is_remote_frame:
                    continue
                data, channel = bytes(message.data), message.channel
                if len(data) > 64:
                    raise ValueError(f"a frame of {len(data)} bytes")
                where = channel if isinstance(channel, int) else -1
                head = message.timestamp, message.arbitration_id, message.is_extended_id
                out.write(RECORD.pack(FRAME, *head, where, len(data), data))
    except NotImplementedError:
        kind = NO_READER
    except MemoryError:
        kind = TOO_LARGE
    except Exception as error:  # it raises whatever it met
        kind, text = UNREADABLE, str(error)
    out.write(RECORD.pack(kind, 0.0, 0, False, 0, 0, b""))
    out.write(text.encode("utf-8", "replace"))


def _leave_formulas_alone() -> None:
    """Refuse channels that a formula converts: asammdf hands its text to `eval`, whatever is in it."""
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
    """Read the log that is named, with the seconds of silence; what the libraries say goes nowhere."""
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # which ends a process even in compiled code
    signal.setitimer(signal.ITIMER_PROF, float(sys.argv[2]))
    with os.fdopen(os.dup(1), "wb") as out:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        send(sys.argv[1], float(sys.argv[2]), out)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):  # who asked has gone
        os._exit(1)
