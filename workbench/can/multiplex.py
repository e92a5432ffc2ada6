"""Subframes: the registers of mjbots' controllers, several reads, writes and answers in a CAN-FD frame.

Published as mjlib/multiplex and in moteus, docs/protocol/can.md: kind of subframe, number of registers (in
two bits, or on its own where there are more than three), first register, values.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from math import nan

from .frame import FrameError

WRITE, READ, REPLY = 0x00, 0x10, 0x20
_ERRORS, _NOP = (0x30, 0x31), 0x50
_TYPES = "bhif"  # bits 2 and 3 of a subframe: int8, int16, int32, float
_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)  # of CAN-FD
_WHOLE = (1.0, 1.0, 1.0, 1.0)

#: Register -> what a step of int8, int16, int32 and float is worth, SI.
Steps = Mapping[int, tuple[float, float, float, float]]


def packed(what: int, values: dict[int, float], kind: int, steps: Steps) -> bytes:
    """Return one subframe of consecutive registers.

    Args:
        what: `WRITE` or `REPLY`.
        values: of registers, SI; what an integer cannot hold becomes the end of it.
        kind: 0 to 3, int8, int16, int32, float.
        steps: what a step of each kind is worth; 1 for a register that is not named.
    """
    first = min(values)
    data = head(what, kind, first, len(values))
    for at, value in values.items():
        raw = value / steps.get(at, _WHOLE)[kind]
        most = 2 ** (8 << kind) // 2 - 1
        data += struct.pack("<" + _TYPES[kind], raw if kind == 3 else min(max(round(raw), -most), most))
    return data


def head(what: int, kind: int, first: int, count: int) -> bytes:
    """Return the beginning of a subframe of `count` registers; a `READ` has nothing else."""
    begin = bytes([what | kind << 2 | count]) if count < 4 else bytes([what | kind << 2, count])
    return begin + (bytes([first]) if first < 0x80 else bytes([first & 0x7F | 0x80, first >> 7]))


def padded(data: bytes) -> bytes:
    """Return the bytes, filled with as many empty ones as CAN-FD needs."""
    return data.ljust(next(length for length in _LENGTHS if length >= len(data)), bytes([_NOP]))


def subframes(data: bytes, steps: Steps) -> Iterator[tuple[int, int, float]]:
    """Return what is written, read (no value) or answered, register by register, SI.

    Raises:
        FrameError: cut off, an error of the drive, or no subframe that there is.
    """
    at = 0

    def varuint() -> int:
        nonlocal at
        value = shift = 0
        while True:
            (byte,) = data[at : at + 1] or b"\xff"
            at += 1
            value, shift = value | (byte & 0x7F) << shift, shift + 7
            if byte < 0x80:
                return value
            if at >= len(data) or shift > 28:
                raise FrameError(f"cut off: {data.hex()}")

    while at < len(data):
        first, at = data[at], at + 1
        if first == _NOP:
            continue
        if first in _ERRORS:
            raise FrameError(f"the drive refuses register {varuint():#x} with error {varuint()}")
        what, kind = first & 0xF0, first >> 2 & 3
        if what not in (WRITE, READ, REPLY):
            raise FrameError(f"subframe {first:#x}")
        count, register = first & 3 or varuint(), varuint()
        for k in range(min(count, 64)):
            if what == READ:
                yield what, register + k, nan
                continue
            size = (1, 2, 4, 4)[kind]
            if at + size > len(data):
                raise FrameError(f"cut off: {data.hex()}")
            (raw,) = struct.unpack("<" + _TYPES[kind], data[at : at + size])
            none = kind < 3 and raw == -(2 ** (8 << kind) // 2)
            yield what, register + k, nan if none else raw * steps.get(register + k, _WHOLE)[kind]
            at += size
