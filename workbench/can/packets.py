"""Packets between nodes and the bus between processes: one packet per frame.

Kinds: ``S`` send; ``B`` come back on the bus; ``Q`` no echoes, please; ``R`` received; ``E`` echo of an own
frame; ``O`` the node is off; ``F`` the queue is full, the frame was not taken.
"""

from __future__ import annotations

import struct

from .frame import Frame

_HEAD = struct.Struct("<cdI")
_EXTENDED, _FD, _REMOTE = 1 << 31, 1 << 30, 1 << 29
SIZE = _HEAD.size + 64


def pack(kind: bytes, stamp: float = 0.0, frame: Frame | None = None) -> bytes:
    """Return a packet; `stamp` is monotonic time [s]."""
    if frame is None:
        return _HEAD.pack(kind, stamp, 0)
    flags = frame.extended * _EXTENDED | frame.fd * _FD | frame.remote * _REMOTE
    return _HEAD.pack(kind, stamp, frame.id | flags) + frame.data


def unpack(packet: bytes) -> tuple[bytes, float, Frame]:
    """Return kind, stamp [s] and frame.

    Raises:
        ValueError: no packet of this kind.
    """
    if not _HEAD.size <= len(packet) <= SIZE:
        raise ValueError(f"a packet of {len(packet)} bytes")
    kind, stamp, id = _HEAD.unpack_from(packet)
    data, fd = packet[_HEAD.size :], bool(id & _FD)
    if not fd and len(data) > 8:
        raise ValueError(f"a classical frame of {len(data)} bytes")
    return kind, stamp, Frame(id & 0x1FFFFFFF, data, bool(id & _EXTENDED), fd, bool(id & _REMOTE))
