"""An ODrive as seen from its bus: messages of a node, its cascade, endpoints; from its documentation.

It shares no code and no table with the codec of the host; see `moteus_drive`.
"""

from __future__ import annotations

import math
import struct

from workbench.can import Feedback, Frame, FrameError, Parameter, Ranges, Setpoint

_TURN = 2.0 * math.pi
_HEARTBEAT, _ENCODER, _TEMPERATURE, _TORQUES = 0x01, 0x09, 0x15, 0x1C
_BEAT, _WARM = 0.010, 0.100  # s between words that nobody asked for
_LOST, _OVERHEATED = 0xD, 0xC  # as the virtual motor numbers them
_ERRORS = {_LOST: 0x1000000, _OVERHEATED: 0x4000}
_NO_WATCHDOG = 0.0


class OdriveDrive:
    """One drive; see `Speaker`.

    Args:
        id: of the node.
        ranges: what it is configured with.
        timeout, enable: endpoints of its watchdog; None where its firmware has none there.
    """

    name = "odrive"

    def __init__(
        self, id: int, ranges: Ranges, timeout: int | None = None, enable: int | None = None
    ) -> None:
        self.id, self.ranges = id, ranges
        self.parameters = ("watchdog",) if timeout is not None else ()
        self._ends, self._timeout, self._on = (timeout, enable), 0.0, False
        self._mode, self._stiff, self._damped = (0, 0), 20.0, 0.16
        self._owed: list[int] = []  # messages that remote frames asked for
        self._parameters: list[Frame] = []
        self._beat = self._warm = -math.inf

    def asked(self, frame: Frame) -> list[Setpoint | Parameter | str]:
        """Return what a frame commands the drive; nothing if the frame is not for it."""
        if frame.extended or frame.fd or frame.id // 32 != self.id:
            return []
        message, data = frame.id % 32, frame.data
        if frame.remote:
            self._owed.append(message)
            return ["look"]
        try:
            return self._obey(message, data)
        except struct.error:  # too short
            return []

    def answer(self, feedback: Feedback) -> tuple[Frame, ...]:
        """Return the answer to what was asked."""
        said = [self._say(message, feedback) for message in self._owed]
        self._owed.clear()
        told, self._parameters = self._parameters, []
        return (*(frame for frame in said if frame), *told)

    def unasked(self, feedback: Feedback, now: float) -> list[Frame]:
        """Return the messages that it sends by itself at this time [s]."""
        due = []
        if now - self._beat >= _BEAT - 1e-9:
            self._beat = now
            due.append(self._say(_HEARTBEAT, feedback))
        if now - self._warm >= _WARM - 1e-9:
            self._warm = now
            due.append(self._say(_TEMPERATURE, feedback))
        return [frame for frame in due if frame]

    def tell(self, parameter: Parameter) -> Frame:
        """Not used: endpoints are sent only when a frame asks for them.

        Raises:
            FrameError: always.
        """
        raise FrameError("an odrive answers queries only")

    def confirm(self, parameter: Parameter) -> None:
        """Not used: nothing is confirmed."""

    def _obey(self, message: int, data: bytes) -> list[Setpoint | Parameter | str]:
        match message:
            case 0x04:
                return self._endpoint(data)
            case 0x07:
                (state,) = struct.unpack_from("<I", data)
                return ["enable" if state == 8 else "disable"]
            case 0x0B:
                self._mode = struct.unpack_from("<II", data)
            case 0x0C:
                p, v, t = struct.unpack_from("<fhh", data)
                return [self._setpoint(p, 0.001 * v, 0.001 * t)]
            case 0x18:
                return ["clear"]
            case 0x19:
                return ["zero"]
            case 0x1A:
                (self._stiff,) = struct.unpack_from("<f", data)
            case 0x1B:
                self._damped, _ = struct.unpack_from("<ff", data)
        return []

    def _setpoint(self, p: float, v: float, t: float) -> Setpoint:
        """What its cascade makes of an input, in radians; nothing in a mode other than position, at once."""
        if self._mode != (3, 1):
            return Setpoint(0.0, 0.0, 0.0, 0.0, 0.0)
        kd = self._damped / _TURN
        return Setpoint(p * _TURN, v * _TURN, kd * self._stiff, kd, t)

    def _endpoint(self, data: bytes) -> list[Setpoint | Parameter | str]:
        writes, endpoint, _ = struct.unpack_from("<BHB", data)
        timeout, enable = self._ends
        if endpoint not in (timeout, enable):
            return []
        if writes:
            if endpoint == timeout:
                (self._timeout,) = struct.unpack_from("<f", data, 4)
            else:
                self._on = bool(data[4])
            return [Parameter("watchdog", self._timeout if self._on else _NO_WATCHDOG)]
        value = struct.pack("<f", self._timeout) if endpoint == timeout else bytes([self._on])
        body = struct.pack("<BHB", 0, endpoint, 0) + value
        self._parameters.append(Frame(self.id * 32 + 0x05, body))
        return ["look"]

    def _say(self, message: int, feedback: Feedback) -> Frame | None:
        match message:
            case 0x01:
                error = _ERRORS.get(feedback.fault, feedback.fault)
                body = struct.pack("<IBBBx", error, 8 if feedback.enabled else 1, 0, 0)
            case 0x09:
                body = struct.pack("<ff", feedback.position / _TURN, feedback.velocity / _TURN)
            case 0x15:
                warm = feedback.temperature or 0.0
                body = struct.pack("<ff", warm, math.nan)  # no thermistor in the motor
            case 0x1C:
                body = struct.pack("<ff", feedback.torque, feedback.torque)
            case _:
                return None
        return Frame(self.id * 32 + message, body)
