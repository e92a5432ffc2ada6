"""BLF logs with damaged ends: python-can's reader would never finish reading them.

By hand, for at an object of no size it gives the same frame again and again: no limit on time or silence
tells that from a long log.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

_FILE = struct.Struct("<4sL")  # "LOGG" and the size of what stands before the first object
_OBJECT = struct.Struct("<4sHHLL")  # "LOBJ", size of its header, version, its own size, its kind
_CONTAINER, _PACKING, _DEFLATED = 10, 16, 2  # kind; bytes before what it contains; how that is packed


def check_blf(path: Path) -> None:
    """Check all objects of a log, including those in containers.

    Raises:
        ValueError, struct.error, zlib.error: it is no BLF, or an object is shorter than its own header.
    """
    raw = path.read_bytes()
    mark, size = _FILE.unpack_from(raw)
    if mark != b"LOGG":
        raise ValueError("does not begin as a BLF log")
    rest, at = b"", size
    while at + _OBJECT.size <= len(raw):
        _, _, _, size, kind = _object(raw, at)
        if kind == _CONTAINER and size >= _OBJECT.size + _PACKING:
            held = raw[at + _OBJECT.size + _PACKING : at + size]
            packing = struct.unpack_from("<H", raw, at + _OBJECT.size)[0]
            if packing in (0, _DEFLATED):  # of others the reader itself says that it cannot
                rest = _walk(rest + (zlib.decompressobj().decompress(held) if packing else held))
        at += size + size % 4


def _walk(data: bytes) -> bytes:
    """Walk over the objects; returns what is left of one that continues in the next container."""
    at = 0
    while True:
        found = data.find(b"LOBJ", at, at + 8)
        if found < 0 or found + _OBJECT.size > len(data):
            return data[at:]
        size = _object(data, found)[3]
        if found + size > len(data):
            return data[at:]
        at = found + size


def _object(data: bytes, at: int) -> tuple[bytes, int, int, int, int]:
    header = _OBJECT.unpack_from(data, at)
    if header[0] != b"LOBJ":
        raise ValueError("an object is missing where the one before it ends")
    if header[3] < _OBJECT.size:
        raise ValueError(f"an object of {header[3]} bytes is shorter than its header")
    return header
