"""Damiao drives: the MIT command, answers with status and two temperatures, and registers.

An answer comes on the drive's own master id: status in the upper and id in the lower half of byte 0, then
motion as in the MIT protocol, MOSFET and rotor temperature. Registers are asked for on 0x7FF: id, 0x33 (read)
or 0x55 (write), number, four bytes little-endian; the answer has the same form on the master id.
"""

from __future__ import annotations

import struct
from math import isfinite

from .frame import Frame, FrameError
from .messages import Action, Feedback, Parameter, ParameterName, Ranges, Read, Setpoint, fields
from .mit import _BITS, Mit, pack_motion, special, unpack_motion, unpack_setpoint

REGISTERS_ID = 0x7FF
_READ, _WRITE = 0x33, 0x55
_REGISTERS: dict[ParameterName, int] = {
    "watchdog": 9, "mode": 10, "position": 21, "velocity": 22, "torque": 23,
}  # fmt: skip
_NAMES: dict[int, ParameterName] = {number: name for name, number in _REGISTERS.items()}
_WATCHDOG_UNIT = 50e-6  # s
_DISABLED, _ENABLED = 0, 1
_FAULTS = {
    8: "over-voltage", 9: "under-voltage", 10: "over-current", 11: "hot MOSFET", 12: "hot rotor",
    13: "no command within its watchdog", 14: "overload",
}  # fmt: skip


class Damiao(Mit):
    """One drive; see `Mit`. Its id has 4 bits, as its answers have room for no more."""

    name = "damiao"
    parameters = ("watchdog", "mode", "position", "velocity", "torque")

    def __init__(self, id: int, reply_id: int, ranges: Ranges) -> None:
        super().__init__(id, reply_id, ranges)
        if not 0 <= id <= 0xF or REGISTERS_ID in (id, reply_id):
            raise FrameError(f"id {id:#x}: a Damiao drive has 0 to 0xF, and its answers do not have 0x7FF")
        self.fields = fields(ranges, _BITS, kept=1)

    def explain(self, fault: int) -> str:
        """Return the name of a fault, by the number in the feedback."""
        return _FAULTS.get(fault, f"number {fault}")

    def read(self, name: ParameterName) -> Frame:
        """Return the frame that asks for a parameter."""
        return self._register(REGISTERS_ID, _READ, _REGISTERS[name], b"\0" * 4)

    def write(self, parameter: Parameter) -> Frame:
        """Return the frame that sets a parameter until the drive is switched off.

        Raises:
            FrameError: a number that the register cannot hold.
        """
        return self._register(REGISTERS_ID, _WRITE, _REGISTERS[parameter.name], _to_bytes(parameter))

    def decode(self, frame: Frame) -> Feedback | Parameter | None:
        """Return the content of a frame of this drive; None if the frame comes from another one.

        Raises:
            FrameError: a frame of this drive with a length, status or register that it does not have.
        """
        if frame.extended or frame.id != self.reply_id:
            return None
        data = frame.data
        if len(data) != 8:
            raise FrameError(f"answer of {len(data)} bytes on {frame.id:#x}")
        if data[0] == self.id and data[1] == 0 and data[2] in (_READ, _WRITE) and data[3] in _NAMES:
            # feedback with status 0 could look the same: position just above -full scale, disabled. It is
            # read as a register's answer then, which no running loop takes for motion.
            # An answer to a write repeats what was written: only a read says what is there.
            return _from_bytes(_NAMES[data[3]], data[4:]) if data[2] == _READ else None
        if data[0] & 0xF != self.id:
            return None
        status = data[0] >> 4
        if status > _ENABLED and status not in _FAULTS:
            raise FrameError(f"answer with status {status:#x} on {frame.id:#x}")
        motion = unpack_motion(data, self.fields)
        fault = status if status in _FAULTS else 0
        return Feedback(*motion, float(max(data[6], data[7])), status == _ENABLED, fault)

    def asked(self, frame: Frame) -> Setpoint | Action | Read | Parameter | None:
        """Return what the host commands this drive; None if the frame is not for it."""
        data = frame.data
        if frame.extended or len(data) != 8:
            return None
        if frame.id == REGISTERS_ID:
            if int.from_bytes(data[:2], "little") != self.id or data[3] not in _NAMES:
                return None
            name = _NAMES[data[3]]
            if data[2] == _READ:
                return Read(name)
            return _from_bytes(name, data[4:]) if data[2] == _WRITE else None
        if frame.id != self.id:
            return None
        return special(data) or unpack_setpoint(data, self.fields)

    def answer(self, feedback: Feedback) -> Frame:
        """Return the feedback frame; numbers beyond the ranges are clipped."""
        status = feedback.fault or (_ENABLED if feedback.enabled else _DISABLED)
        hot = bytes([min(max(round(feedback.temperature or 0.0), 0), 255)] * 2)
        return Frame(self.reply_id, bytes([status << 4 | self.id]) + pack_motion(feedback, self.fields) + hot)

    def tell(self, parameter: Parameter) -> Frame:
        """Return the answer to a read parameter."""
        return self._register(self.reply_id, _READ, _REGISTERS[parameter.name], _to_bytes(parameter))

    def confirm(self, parameter: Parameter) -> Frame | None:
        """Return the answer to a written parameter."""
        return self._register(self.reply_id, _WRITE, _REGISTERS[parameter.name], _to_bytes(parameter))

    def _register(self, id: int, what: int, register: int, value: bytes) -> Frame:
        return Frame(id, self.id.to_bytes(2, "little") + bytes([what, register]) + value)


def _to_bytes(parameter: Parameter) -> bytes:
    if not isfinite(parameter.value):
        raise FrameError(f"{parameter.name} of {parameter.value} cannot be sent")
    try:
        match parameter.name:
            case "watchdog":
                return struct.pack("<I", round(parameter.value / _WATCHDOG_UNIT))
            case "mode":
                return struct.pack("<I", round(parameter.value))
        return struct.pack("<f", parameter.value)
    except (struct.error, OverflowError) as error:
        raise FrameError(f"{parameter.name} of {parameter.value:g} cannot be sent") from error


def _from_bytes(name: ParameterName, data: bytes) -> Parameter:
    match name:
        case "watchdog":
            return Parameter(name, int.from_bytes(data, "little") * _WATCHDOG_UNIT)
        case "mode":
            return Parameter(name, float(int.from_bytes(data, "little")))
    return Parameter(name, struct.unpack("<f", data)[0])
