"""What nodes and the bus between processes send each other: one packet a frame.

Kinds: ``S`` send; ``B`` come back on the bus; ``Q`` no echoes, please; ``R`` received; ``E`` echo of an own
frame; ``O`` the node is off; ``F`` the queue is full, the frame was not taken.
"""

from __future__ import annotations

import struct

from .frame import Frame

_LAYOUT = struct.Struct("<cdIB8s")
_EXTENDED = 1 << 31
SIZE = _LAYOUT.size


def pack(kind: bytes, stamp: float = 0.0, frame: Frame | None = None) -> bytes:
    """A packet; `stamp` is monotonic time [s]."""
    if frame is None:
        return _LAYOUT.pack(kind, stamp, 0, 0, b"")
    id = frame.id | (_EXTENDED if frame.extended else 0)
    return _LAYOUT.pack(kind, stamp, id, len(frame.data), frame.data)


def unpack(packet: bytes) -> tuple[bytes, float, Frame]:
    """Kind, stamp [s] and frame.

    Raises:
        ValueError: no packet of this kind.
    """
    if len(packet) != SIZE:
        raise ValueError(f"a packet of {len(packet)} bytes")
    kind, stamp, id, length, data = _LAYOUT.unpack(packet)
    return kind, stamp, Frame(id & 0x1FFFFFFF, data[: min(length, 8)], bool(id & _EXTENDED))
