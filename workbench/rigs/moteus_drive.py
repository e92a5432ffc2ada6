"""A moteus as seen from its bus: registers that frames write and read, from its documentation.

It shares no code with the codec of the host, so that what both get wrong in the same way is not what they
agree upon. Of the types it takes all four; it answers in the one that it was asked in.
"""

from __future__ import annotations

import math
import struct

from workbench.can import Feedback, Frame, FrameError, Parameter, Ranges, Setpoint

_TURN = 2.0 * math.pi
_STOP, _FAULT, _POSITION, _TIMEOUT, _ZERO_VELOCITY = 0, 1, 10, 11, 12
_LOST, _OVERHEATED = 0xD, 0xC  # as the virtual motor numbers them
_HOT = 38  # as a moteus numbers it
_DEFAULT_TIMEOUT = 0.1  # s, of a command that brings none
_SIZES = (1, 2, 4, 4)
_MOTION = {0x01: (0.01, 0.0001, 0.00001), 0x02: (0.1, 0.00025, 0.00001)}  # rev, rev/s
_OWN_SCALES: dict[int, tuple[float, float, float]] = {
    0x00: (1, 1, 1), 0x0F: (1, 1, 1),
    **_MOTION, 0x20: _MOTION[1], 0x21: _MOTION[2], 0x130: _MOTION[1],
    **dict.fromkeys((3, 34, 37), (0.5, 0.01, 0.001)),
    **dict.fromkeys((35, 36), (1 / 127, 1 / 32767, 1 / 2147483647)),
    0x0D: (0.5, 0.1, 0.001), 0x0E: (1, 0.1, 0.001), 0x27: (0.01, 0.001, 0.000001),
}  # fmt: skip


class MoteusDrive:
    """One drive; see `Speaker`.

    Args:
        id, host_id: 7 bits each.
        ranges: kp and kd are those that it is configured with, at the output.
    """

    name = "moteus"
    parameters = ("watchdog",)

    def __init__(self, id: int, host_id: int, ranges: Ranges) -> None:
        self.id, self.host_id, self.ranges = id, host_id, ranges
        self._command: dict[int, float] = {}
        self._owed: list[list[tuple[int, int]]] = []  # register and type, a list an answer

    def asked(self, frame: Frame) -> list[Setpoint | Parameter | str]:
        """Return what a frame commands the drive; nothing if the frame is not for it."""
        if not (frame.fd and frame.extended) or frame.id & 0x7FFF != self.host_id * 256 + self.id:
            return []
        try:
            written, wanted = _read(frame.data)
        except (IndexError, struct.error):
            return []
        if frame.id & 0x8000 and wanted:
            self._owed.append(wanted)
        if 0x130 in written:
            return ["zero"]
        if 0x00 in written:
            self._command = {}
        self._command.update(written)
        if 0x00 not in written:
            return ["look"] if wanted else []
        patience = self._command.get(0x27, 0.0) or _DEFAULT_TIMEOUT
        done: list[Setpoint | Parameter | str] = [
            Parameter("watchdog", 0.0 if math.isnan(patience) else patience)
        ]
        mode = written[0x00]
        if mode == _STOP:
            return [*done, "clear"]
        if mode not in (_POSITION, _ZERO_VELOCITY):
            return [*done, "look"]
        return [*done, "enable", self._setpoint(mode == _ZERO_VELOCITY)]

    def answer(self, feedback: Feedback) -> tuple[Frame, ...]:
        """Return the answer to what was asked."""
        mode = _POSITION if feedback.enabled else _STOP
        number = {0: 0, _LOST: 0, _OVERHEATED: _HOT}.get(feedback.fault, feedback.fault)
        if feedback.fault:
            mode = _TIMEOUT if feedback.fault == _LOST else _FAULT
        values = {
            **self._command, 0x00: mode, 0x01: feedback.position / _TURN, 0x02: feedback.velocity / _TURN,
            0x03: feedback.torque, 0x0D: 24.0, 0x0E: feedback.temperature or 0.0, 0x0F: number,
        }  # fmt: skip
        owed, self._owed = self._owed, []
        return tuple(self._frame(wanted, values) for wanted in owed)

    def tell(self, parameter: Parameter) -> Frame:
        """Not used: registers are sent only when a frame asks for them.

        Raises:
            FrameError: always.
        """
        raise FrameError("a moteus answers queries only")

    def confirm(self, parameter: Parameter) -> None:
        """Not used: nothing is confirmed."""

    def _setpoint(self, damps: bool) -> Setpoint:
        c, r = self._command, self.ranges
        if damps:
            return Setpoint(0.0, 0.0, 0.0, r.kd, 0.0)
        stiff = c.get(0x23, 1.0)
        damped = min(c.get(0x24, 1.0), stiff)
        most = c.get(0x25, math.nan)
        torque = c.get(0x22, 0.0)
        torque = torque if math.isnan(most) else max(-most, min(most, torque))
        position = c.get(0x20, 0.0) * _TURN
        return Setpoint(position, c.get(0x21, 0.0) * _TURN, stiff * r.kp, damped * r.kd, torque)

    def _frame(self, wanted: list[tuple[int, int]], values: dict[int, float]) -> Frame:
        data = bytearray()
        while wanted:
            first, kind = wanted[0]
            run = [at for k, at in enumerate(wanted) if at == (first + k, kind)]
            wanted = wanted[len(run) :]
            few = len(run) if len(run) < 4 else 0
            data += bytes([0x20 | kind << 2 | few, *([] if few else [len(run)]), first])
            for register, _ in run:
                data += _value(register, kind, values.get(register, 0.0))
        for length in (*range(9), 12, 16, 20, 24, 32, 48, 64):
            if length >= len(data):
                data += b"\x50" * (length - len(data))
                break
        id = self.id * 256 + self.host_id
        return Frame(id, bytes(data), id >= 2048, fd=True)


def _read(data: bytes) -> tuple[dict[int, float], list[tuple[int, int]]]:
    """Registers written, in turns, and registers asked for with their type."""
    written: dict[int, float] = {}
    wanted: list[tuple[int, int]] = []
    rest = list(data)
    while rest:
        begin = rest.pop(0)
        if begin == 0x50:
            continue
        what, kind, count = begin >> 4, begin >> 2 & 3, begin & 3
        if what not in (0, 1):
            raise IndexError(begin)
        count = count or _number(rest)
        first = _number(rest)
        for register in range(first, first + count):
            if what == 1:
                wanted.append((register, kind))
                continue
            raw, rest = bytes(rest[: _SIZES[kind]]), rest[_SIZES[kind] :]
            written[register] = _meant(register, kind, raw)
    return written, wanted


def _number(rest: list[int]) -> int:
    """Seven bits a byte, lowest first."""
    value, place = 0, 1
    while True:
        byte = rest.pop(0)
        value, place = value + (byte % 128) * place, place * 128
        if byte < 128:
            return value


def _meant(register: int, kind: int, raw: bytes) -> float:
    (value,) = struct.unpack(("<b", "<h", "<i", "<f")[kind], raw)
    if kind == 3:
        return float(value)
    if value == -(1 << (8 * _SIZES[kind] - 1)):
        return math.nan
    return value * _OWN_SCALES.get(register, (1, 1, 1))[kind]


def _value(register: int, kind: int, value: float) -> bytes:
    if kind == 3:
        return struct.pack("<f", value)
    end = (1 << (8 * _SIZES[kind] - 1)) - 1
    raw = round(value / _OWN_SCALES.get(register, (1, 1, 1))[kind])
    return struct.pack(("<b", "<h", "<i")[kind], max(-end, min(end, raw)))
