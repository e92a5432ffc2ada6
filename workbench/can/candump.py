"""Logs in the form of candump: one line per frame, readable up to its last complete line.

By hand: python-can's reader takes a line that was cut off for a shorter frame, and does not name bad ones.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from workbench.core import InputError
from workbench.core.files import read_file

from .frame import Frame

_LINE = re.compile(
    r"^\((\d{1,12}\.\d{1,12})\) (\S+) ([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})"
    r"#(?:((?:[0-9A-Fa-f]{2}){0,8})|#[0-9A-Fa-f]((?:[0-9A-Fa-f]{2}){0,64})|(R)[0-8]?)(?: [RT])?$",
    re.ASCII,
)


_SWITCHED = "#1"  # CAN-FD, its rate switched


class Logged(NamedTuple):
    """A frame in a log: time stamp [s], bus and frame."""

    stamp: float
    bus: str
    frame: Frame


def line(stamp: float, bus: str, frame: Frame) -> str:
    """Return one line of a log, with its newline."""
    id = f"{frame.id:08X}" if frame.extended else f"{frame.id:03X}"
    content = "R" if frame.remote else (_SWITCHED if frame.fd else "") + frame.data.hex().upper()
    return f"({stamp:.6f}) {bus} {id}#{content}\n"


def read_candump(path: str | Path) -> Iterator[Logged]:
    """Return the data frames of a candump log; the last line may be incomplete.

    Raises:
        InputError: the file cannot be read, or a line that is not its last is none of a log.
    """
    path = Path(path)
    lines = read_file(path).decode("ascii", "replace").replace("\r\n", "\n").split("\n")
    # behind the last newline stands nothing, or a line that was being written
    for number, text in enumerate(lines[:-1], 1):
        found = _LINE.match(text)
        if found is None:
            if not text.strip():
                continue
            raise InputError(f"is not a line of a candump log: '{text[:40]}'", file=path, row=number,
                             remedy="record with 'candump -L'")  # fmt: skip
        stamp, bus, id, data, flexible, remote = found.groups()
        content, extended = bytes.fromhex(flexible or data or ""), len(id) == 8
        frame = Frame(int(id, 16), content, extended, flexible is not None, remote is not None)
        yield Logged(float(stamp), bus, frame)


def packed(log: str | Path) -> tuple[int, bytes]:
    """Return the number of frames of a candump log, and the log as BLF.

    Raises:
        InputError: the log cannot be read, or there is no room for a file that is needed in between.
    """
    import can  # takes seconds to load, and only an archive needs it

    from .messages_of_can import to_message

    count, channels = 0, {}
    try:
        with TemporaryDirectory() as folder:
            part = Path(folder) / "log.blf"
            with can.BLFWriter(str(part)) as writer:
                for stamp, bus, frame in read_candump(log):
                    channel = channels.setdefault(bus, len(channels))
                    writer(to_message(frame, timestamp=stamp, channel=channel))
                    count += 1
            return count, part.read_bytes()
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"cannot be made a BLF file ({reason})", file=log, remedy="free the disk of temporary files"
        ) from error
