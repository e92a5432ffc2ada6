"""Robstride and CyberGear drives: 29-bit identifiers that carry type, 16 bits of data, and an address.

Type 1 is the command, its torque in the identifier; 2 feedback with mode and faults in the identifier; 3
enables, 4 stops (and clears faults), 6 sets zero, 17 reads and 18 writes a parameter, 21 reports faults.
Run mode 0 of parameter 0x7005, in which type 1 is followed, is mode 1 here, as with the other drives.
"""

from __future__ import annotations

import struct
from math import isfinite

from .frame import Frame, FrameError
from .messages import Action, Fault, Feedback, Parameter, ParameterName, Ranges, Read, Setpoint, fields
from .packed import Packed

_COMMAND, _FEEDBACK, _ENABLE, _STOP, _ZERO, _READ, _WRITE, _FAULT = 1, 2, 3, 4, 6, 17, 18, 21
_INDICES: dict[ParameterName, int] = {"mode": 0x7005, "watchdog": 0x7028}
_NAMES: dict[int, ParameterName] = {index: name for name, index in _INDICES.items()}
_WATCHDOG_UNIT = 1.0 / 20000  # s; 0 is off, and off is the factory setting
_RUNNING = 2
#: Bits 16 to 21 of a feedback's identifier, lowest first.
_FAULT_NAMES = (
    "under-voltage",
    "over-current",
    "hot motor",
    "magnetic encoder",
    "Hall encoder",
    "not calibrated",
)


class Robstride(Packed):
    """One drive.

    Args:
        id: of the drive, 8 bits.
        host_id: to which it answers, 8 bits.
        ranges: of the fields.
    """

    name = "robstride"
    extended = True
    parameters: tuple[ParameterName, ...] = ("watchdog", "mode")
    length = 8

    def __init__(self, id: int, host_id: int, ranges: Ranges) -> None:
        if not (0 <= id <= 0xFF and 0 <= host_id <= 0xFF) or id == host_id:
            raise FrameError(f"ids {id:#x} and {host_id:#x}: give two different ones of 8 bits")
        self.id, self.reply_id, self.ranges = id, host_id, ranges
        self.fields = fields(ranges, (16, 16, 16, 16, 16))

    # What a host needs.

    def explain(self, fault: int) -> str:
        """Return the names of the faults whose bits are set in the feedback."""
        return (
            ", ".join(name for bit, name in enumerate(_FAULT_NAMES) if fault >> bit & 1) or f"number {fault}"
        )

    def command(self, setpoint: Setpoint) -> Frame:
        """Return the frame of a setpoint.

        Raises:
            FrameError: not finite, or outside the ranges.
        """
        p, v, kp, kd, t = (span.encode(x) for span, x in zip(self.fields, setpoint, strict=True))
        return self._frame(_COMMAND, t, struct.pack(">4H", p, v, kp, kd))

    def act(self, action: Action) -> Frame:
        """Return the frame of an action."""
        kind = {"enable": _ENABLE, "disable": _STOP, "zero": _ZERO, "clear": _STOP}[action]
        first = action in ("zero", "clear")
        return self._frame(kind, self.reply_id, bytes([first]) + b"\0" * 7)

    def read(self, name: ParameterName) -> Frame:
        """Return the frame that asks for a parameter.

        Raises:
            FrameError: these drives do not tell it.
        """
        return self._frame(_READ, self.reply_id, struct.pack("<HHI", _index(name), 0, 0))

    def write(self, parameter: Parameter) -> Frame:
        """Return the frame that sets a parameter until the drive is switched off.

        Raises:
            FrameError: these drives have none of that name, or it cannot hold that number.
        """
        return self._frame(_WRITE, self.reply_id, _parameter(parameter))

    def decode(self, frame: Frame) -> Feedback | Parameter | Fault | None:
        """Return the content of a frame of this drive; None if the frame comes from another one.

        Raises:
            FrameError: a frame of this drive with a length or parameter that it does not have.
        """
        kind, middle, last = frame.id >> 24, frame.id >> 8 & 0xFFFF, frame.id & 0xFF
        if not frame.extended or last != self.reply_id or middle & 0xFF != self.id:
            return None
        if kind not in (_FEEDBACK, _READ, _FAULT):
            return None
        if len(frame.data) != 8:
            raise FrameError(f"answer of {len(frame.data)} bytes on {frame.id:#x}")
        if kind == _READ:
            index, _ = struct.unpack("<HH", frame.data[:4])
            if index not in _NAMES:
                raise FrameError(f"answer with parameter {index:#x} on {frame.id:#x}")
            return _value(_NAMES[index], frame.data)
        if kind == _FAULT:
            fault = struct.unpack("<I", frame.data[:4])[0]
            return Fault(fault) if fault else None
        p, v, t, temperature = struct.unpack(">4H", frame.data)
        f, mode = self.fields, middle >> 14
        return Feedback(
            f.position.decode(p), f.velocity.decode(v), f.torque.decode(t),
            temperature / 10, mode == _RUNNING, middle >> 8 & 0x3F,
        )  # fmt: skip

    # What a drive needs.

    def asked(self, frame: Frame) -> Setpoint | Action | Read | Parameter | None:
        """Return what the host commands this drive; None if the frame is not for it."""
        kind, middle, last = frame.id >> 24, frame.id >> 8 & 0xFFFF, frame.id & 0xFF
        if not frame.extended or last != self.id or len(frame.data) != 8:
            return None
        if kind == _COMMAND:
            f, (p, v, kp, kd) = self.fields, struct.unpack(">4H", frame.data)
            return Setpoint(
                f.position.decode(p), f.velocity.decode(v), f.kp.decode(kp), f.kd.decode(kd),
                f.torque.decode(middle),
            )  # fmt: skip
        if kind == _STOP:
            return "clear" if frame.data[0] else "disable"
        if kind in (_ENABLE, _ZERO):
            return "enable" if kind == _ENABLE else "zero"
        index = struct.unpack("<H", frame.data[:2])[0]
        if kind not in (_READ, _WRITE) or index not in _NAMES:
            return None
        return Read(_NAMES[index]) if kind == _READ else _value(_NAMES[index], frame.data)

    def answer(self, feedback: Feedback) -> Frame:
        """Return the feedback frame; numbers beyond the ranges are clipped."""
        mode = _RUNNING if feedback.enabled else 0
        middle = mode << 14 | (feedback.fault & 0x3F) << 8 | self.id
        temperature = min(max(round(10 * (feedback.temperature or 0.0)), 0), 0xFFFF)
        data = struct.pack(">4H", *self.fields.clipped(feedback), temperature)
        return Frame(_FEEDBACK << 24 | middle << 8 | self.reply_id, data, True)

    def tell(self, parameter: Parameter) -> Frame:
        """Return the answer to a read parameter."""
        return Frame(_READ << 24 | self.id << 8 | self.reply_id, _parameter(parameter), True)

    def confirm(self, parameter: Parameter) -> Frame | None:
        """Return the answer to a written parameter: this protocol has none."""
        return None

    def _frame(self, kind: int, middle: int, data: bytes) -> Frame:
        return Frame(kind << 24 | middle << 8 | self.id, data, True)


def _index(name: ParameterName) -> int:
    if name not in _INDICES:
        raise FrameError(f"robstride drives do not report their {name}")
    return _INDICES[name]


def _parameter(parameter: Parameter) -> bytes:
    head = struct.pack("<HH", _index(parameter.name), 0)
    if not isfinite(parameter.value):
        raise FrameError(f"{parameter.name} of {parameter.value} cannot be sent")
    if parameter.name == "mode":
        value = round(parameter.value) - 1
    else:
        value = round(parameter.value / _WATCHDOG_UNIT)
    try:
        return head + struct.pack("<I", value)
    except struct.error as error:
        raise FrameError(f"{parameter.name} of {parameter.value:g} cannot be sent") from error


def _value(name: ParameterName, data: bytes) -> Parameter:
    if name == "mode":
        return Parameter(name, data[4] + 1.0)
    return Parameter(name, struct.unpack("<I", data[4:])[0] * _WATCHDOG_UNIT)
