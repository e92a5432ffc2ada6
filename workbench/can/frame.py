"""A CAN frame, and its number of bits on the wire; the time of CAN-FD is in `flexible`."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from workbench.core import WorkbenchError


class FrameError(WorkbenchError):
    """A frame that does not exist in the protocol, or a number that a frame cannot hold."""


class Frame(NamedTuple):
    """A frame.

    Attributes:
        id: arbitration identifier, 11 bits, or 29 where `extended`.
        data: 0 to 8 bytes; of CAN-FD one of `FD_LENGTHS`.
        extended: whether the identifier has 29 bits.
        fd: whether it is a CAN-FD frame, its data at the bus's faster rate.
        remote: whether it has no data, and asks for the frame of this identifier.
    """

    id: int
    data: bytes
    extended: bool = False
    fd: bool = False
    remote: bool = False

    @property
    def priority(self) -> tuple[int, int, int]:
        """Return the sort key of arbitration: lowest identifier first, standard frames first."""
        if self.extended:
            return self.id >> 18, 1, (self.id & 0x3FFFF) << 1 | self.remote
        return self.id, 0, self.remote << 19


#: Bytes that a CAN-FD frame can have.
FD_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)
_AFTER = 13  # bits behind the checksum: its delimiter, acknowledge and delimiter, end of frame, intermission
_POLYNOMIAL = 0x4599  # CRC-15-CAN


def worst_bits(length: int, extended: bool = False) -> int:
    """Return the largest number of bits of a frame with `length` bytes, with stuffing and intermission.

    The first stuff bit takes five equal bits, every further one four more (Davis, Burns, Bril and Lukkien,
    Real-Time Systems 35, 2007, Eq. 1).
    """
    stuffed = (54 if extended else 34) + 8 * length
    return stuffed + _AFTER + (stuffed - 1) // 4


def frame_bits(frame: Frame) -> int:
    """Return the number of bits of this classical frame on the wire, with stuffing and intermission."""
    length = len(frame.data)
    data = int.from_bytes(frame.data, "big")
    if frame.extended:
        base, rest = frame.id >> 18, frame.id & 0x3FFFF
        head, size = (
            ((base << 2 | 0b11) << 18 | rest) << 7 | frame.remote << 6 | length,
            39,
        )  # SOF 0, id, SRR 1, IDE 1, id, RTR r1 r0
    else:
        head, size = frame.id << 7 | frame.remote << 6 | length, 19  # start, id, RTR, IDE and r0 0, length
    content, bits = head << 8 * length | data, size + 8 * length
    content, bits = content << 15 | _checksum(content, bits), bits + 15
    return bits + stuffing(content, bits) + _AFTER


def stuffing(content: int, bits: int) -> int:
    """Return the number of stuff bits in these bits, the first of which follows an idle bus."""
    # bits before the start of frame that end in 1 change no run of equal bits
    spare = -bits % 8
    content |= (0x55 & ((1 << spare) - 1)) << bits
    state, stuffed, table = 0, 0, _stuffing()
    for byte in content.to_bytes((bits + spare) // 8, "big"):
        state, more = table[state << 8 | byte]
        stuffed += more
    return stuffed


def _checksum(content: int, bits: int) -> int:
    """CRC-15 of the bits before it; zeros in front change nothing."""
    table, crc = _checksums(), 0
    for byte in content.to_bytes((bits + 7) // 8, "big"):
        crc = (crc << 8 & 0x7FFF) ^ table[crc >> 7 ^ byte]
    return crc


@lru_cache(maxsize=1)
def _checksums() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte << 7
        for _ in range(8):
            crc = (crc << 1 ^ (_POLYNOMIAL if crc & 0x4000 else 0)) & 0x7FFF
        table.append(crc)
    return table


@lru_cache(maxsize=1)
def _stuffing() -> list[tuple[int, int]]:
    """State (last bit and run of equal bits) and byte -> state behind it and bits stuffed in between."""
    table = []
    for state in range(10):
        for byte in range(256):
            last, run = (1 if state == 0 else state // 5), state % 5
            stuffed = 0
            for k in range(7, -1, -1):
                bit = byte >> k & 1
                run = run + 1 if bit == last else 1
                last = bit
                if run == 5:
                    stuffed += 1
                    last, run = 1 - bit, 1
            table.append((last * 5 + run, stuffed))
    return table
