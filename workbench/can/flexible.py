"""The time of frames on a bus with two rates: CAN-FD sends its data faster than its arbitration.

Bits of ISO 11898-1:2015: from the start of frame to the bit that switches the rate, and behind the checksum,
at the slow rate; what lies between at the fast one. Stuffing is as in classical frames up to the data; the
checksum has a stuff bit of fixed place before it and behind every fourth bit.
"""

from __future__ import annotations

from .frame import Frame, frame_bits, stuffing, worst_bits

_HEAD = {False: 17, True: 36}  # start, identifier(s), RRS, (SRR,) IDE, FDF, res, BRS
_LENGTH = 5  # ESI, and the length's code
_AFTER = 12  # acknowledge and its delimiter, end of frame, intermission: the checksum's delimiter is fast
_CODES = {12: 9, 16: 10, 20: 11, 24: 12, 32: 13, 48: 14, 64: 15}


def _checksum(length: int) -> int:
    """Bits of stuff count, checksum, their fixed stuffing, and the delimiter."""
    size = 4 + (17 if length <= 16 else 21)
    return size + 1 + size // 4 + 1


def seconds(frame: Frame, bitrate: float, data_bitrate: float) -> float:
    """Return the time of this frame [s]; rates [bit/s], the second one for the data of CAN-FD."""
    if not frame.fd:
        return frame_bits(frame) / bitrate
    length, size = len(frame.data), _HEAD[frame.extended]
    if frame.extended:  # SRR and IDE 1, RRS 0, FDF 1, res 0, BRS 1
        head = ((frame.id >> 18) << 2 | 0b11) << 18 | frame.id & 0x3FFFF
        head = head << 4 | 0b0101
    else:  # RRS and IDE 0, FDF 1, res 0, BRS 1
        head = frame.id << 5 | 0b00101
    body = (_CODES.get(length, length)) << 8 * length | int.from_bytes(frame.data, "big")
    bits = _LENGTH + 8 * length
    slow = stuffing(head, size)
    fast = stuffing(head << bits | body, size + bits) - slow
    return (size + slow + _AFTER) / bitrate + (bits + fast + _checksum(length)) / data_bitrate


def worst_seconds(
    length: int, extended: bool, fd: bool, bitrate: float, data_bitrate: float
) -> float:  # fmt: skip
    """Return the longest time [s] of a frame with so many bytes; see `seconds`."""
    if not fd:
        return worst_bits(length, extended) / bitrate
    head, body = _HEAD[extended], _LENGTH + 8 * length
    slow = (head - 1) // 4
    fast = (head + body - 1) // 4 - slow
    return (head + slow + _AFTER) / bitrate + (body + fast + _checksum(length)) / data_bitrate
