"""The MIT protocol, as CubeMars AK drives speak it.

Command to the drive's id, big-endian: position 16 bits, velocity 12, kp 12, kd 12, torque 12. Enter, exit and
zero are seven bytes 0xFF and FC, FD or FE: a command of full scale would be one of them, so the last position
step is never sent. The answer comes on an id that the host chose (factory setting 0), the drive's id in its
first byte, then position 16, velocity 12, torque 12, and by firmware temperature and error.
"""

from __future__ import annotations

from .frame import Frame, FrameError
from .messages import Action, Feedback, Fields, Parameter, ParameterName, Ranges, Read, Setpoint, fields
from .packed import Packed

_BITS = (16, 12, 12, 12, 12)
_SPECIAL: dict[Action, int] = {"enable": 0xFC, "disable": 0xFD, "zero": 0xFE, "clear": 0xFB}
_HEAD = b"\xff" * 7


#: Byte 7 of an answer, as CubeMars numbers it (AK series manual, servo and MIT mode).
_FAULT_NAMES = {
    1: "hot motor", 2: "over-current", 3: "over-voltage", 4: "under-voltage", 5: "encoder", 6: "hot MOSFET",
    7: "stalled motor",
}  # fmt: skip


class Mit(Packed):
    """One drive.

    Args:
        id: of the drive, 11 bits.
        reply_id: of its answers; not its own id, or a host could take its own command for an answer.
        ranges: of the fields.
        temperature_offset: byte + offset is degrees Celsius.
        length: of its answers, 6, 7 or 8 bytes.
    """

    name = "mit"
    extended = False
    parameters: tuple[ParameterName, ...] = ()

    def __init__(
        self, id: int, reply_id: int, ranges: Ranges, temperature_offset: float = -40.0, length: int = 8
    ) -> None:
        if not (0 <= id <= 0xFF and 0 <= reply_id <= 0x7FF) or id == reply_id:
            raise FrameError(f"ids {id:#x} and {reply_id:#x}: a drive has 0 to 0xFF, its answers another")
        self.id, self.reply_id, self.ranges = id, reply_id, ranges
        self.length, self.temperature_offset = length, temperature_offset
        self.fields = fields(ranges, _BITS, kept=1)

    # What a host needs.

    def explain(self, fault: int) -> str:
        """Return the name of a fault, by the number in the feedback."""
        return _FAULT_NAMES.get(fault, f"number {fault}")

    def command(self, setpoint: Setpoint) -> Frame:
        """Return the frame of a setpoint.

        Raises:
            FrameError: not finite, or outside the ranges.
        """
        return Frame(self.id, pack_setpoint(setpoint, self.fields))

    def act(self, action: Action) -> Frame:
        """Return the frame of an action: enable, disable and so on."""
        return Frame(self.id, _HEAD + bytes([_SPECIAL[action]]))

    def read(self, name: ParameterName) -> Frame:
        """Not available in this protocol.

        Raises:
            FrameError: always.
        """
        raise FrameError(f"{self.name} drives cannot be asked for their {name}")

    def write(self, parameter: Parameter) -> Frame:
        """Not available in this protocol.

        Raises:
            FrameError: always.
        """
        raise FrameError(f"{self.name} drives cannot be given their {parameter.name}")

    def decode(self, frame: Frame) -> Feedback | Parameter | None:
        """Return the content of a frame of this drive; None if the frame comes from another one.

        Raises:
            FrameError: a frame of this drive with a length that its answers do not have.
        """
        if frame.extended or frame.id != self.reply_id:
            return None
        data = frame.data
        if not 6 <= len(data) <= 8:
            raise FrameError(f"answer of {len(data)} bytes on {frame.id:#x}")
        if data[0] != self.id:
            return None
        temperature = data[6] + self.temperature_offset if len(data) > 6 else None
        return Feedback(*unpack_motion(data, self.fields), temperature, None, data[7] if len(data) > 7 else 0)

    # What a drive needs.

    def asked(self, frame: Frame) -> Setpoint | Action | Read | Parameter | None:
        """Return what the host commands this drive; None if the frame is not for it."""
        if frame.extended or frame.id != self.id or len(frame.data) != 8:
            return None
        return special(frame.data) or unpack_setpoint(frame.data, self.fields)

    def answer(self, feedback: Feedback) -> Frame:
        """Return the feedback frame; numbers beyond the ranges are clipped."""
        motion = pack_motion(feedback, self.fields)
        temperature = round((feedback.temperature or 0.0) - self.temperature_offset)
        tail = bytes([min(max(temperature, 0), 255), feedback.fault & 0xFF])
        return Frame(self.reply_id, (bytes([self.id]) + motion + tail)[: self.length])

    def tell(self, parameter: Parameter) -> Frame:
        """Not available in this protocol.

        Raises:
            FrameError: always.
        """
        return self.write(parameter)

    def confirm(self, parameter: Parameter) -> Frame | None:
        """Return the answer to a written parameter: this protocol has none."""
        return None


def pack_setpoint(setpoint: Setpoint, f: Fields) -> bytes:
    """Return the eight bytes of a setpoint.

    Raises:
        FrameError: not finite, or outside the fields' ranges.
    """
    p, v, kp, kd, t = (span.encode(value) for span, value in zip(f, setpoint, strict=True))
    return (p << 48 | v << 36 | kp << 24 | kd << 12 | t).to_bytes(8, "big")


def unpack_setpoint(data: bytes, f: Fields) -> Setpoint:
    """Return the setpoint in eight bytes."""
    raw = int.from_bytes(data, "big")
    return Setpoint(
        f.position.decode(raw >> 48),
        f.velocity.decode(raw >> 36 & 0xFFF),
        f.kp.decode(raw >> 24 & 0xFFF),
        f.kd.decode(raw >> 12 & 0xFFF),
        f.torque.decode(raw & 0xFFF),
    )


def special(data: bytes) -> Action | None:
    """Return the action that eight bytes stand for; None if they are a setpoint."""
    if data[:7] != _HEAD:
        return None
    return next((action for action, byte in _SPECIAL.items() if byte == data[7]), None)


def pack_motion(feedback: Feedback, f: Fields) -> bytes:
    """Return five bytes: position 16, velocity 12, torque 12 bits; clipped to the ranges, as drives do."""
    p, v, t = f.clipped(feedback)
    return (p << 24 | v << 12 | t).to_bytes(5, "big")


def unpack_motion(data: bytes, f: Fields) -> tuple[float, float, float]:
    """Return position, velocity and torque in bytes 1 to 5."""
    raw = int.from_bytes(data[1:6], "big")
    return f.position.decode(raw >> 24), f.velocity.decode(raw >> 12 & 0xFFF), f.torque.decode(raw & 0xFFF)
