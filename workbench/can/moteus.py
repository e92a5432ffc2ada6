"""moteus controllers (mjbots): registers in CAN-FD frames, several reads and writes a frame.

Register protocol as published (moteus, docs/protocol). A frame's identifier is source and destination, 7 bits
each, with 0x8000 where an answer is wanted. Values are little-endian int8, int16, int32 or float of the same
quantity in steps of their own; the most negative integer stands for no number. Turns there, radians here.

Gains are scales from 0 to 1 of those that the drive is configured with (``kp``, ``kd`` of the ranges), and it
limits the scale of kd to that of kp. So what damps without stiffness is a mode of its own, with the whole kd.

Tried on the published examples and on a virtual drive of other code, on no hardware.
"""

from __future__ import annotations

from math import isfinite, tau
from typing import Literal

from .frame import Frame, FrameError
from .messages import Action, Carried, Feedback, Parameter, ParameterName, Ranges, Read, Setpoint
from .multiplex import READ, REPLY, WRITE, Steps, head, packed, padded, subframes

_MODE, _POSITION, _VELOCITY, _TORQUE, _VOLTAGE, _TEMPERATURE, _FAULT = 0, 1, 2, 3, 13, 14, 15
_TO_POSITION, _TO_VELOCITY, _TO_TORQUE, _KP, _KD, _MOST, _WATCHDOG = 0x20, 0x21, 0x22, 0x23, 0x24, 0x25, 0x27
_OUTPUT = 0x130  # what its position is to be from now on
_STOPPED, _FAULTY, _FOLLOWS, _TIMEOUT, _DAMPS = 0, 1, 10, 11, 12  # modes
_ANSWER = 0x8000  # is wanted
_ROUNDING = 1e-9  # of two parts that are meant to be the same
#: Register -> what a step of int8, int16, int32 and float is worth, SI.
_STEPS: Steps = {
    **dict.fromkeys((_POSITION, _TO_POSITION, _OUTPUT), (1e-2 * tau, 1e-4 * tau, 1e-5 * tau, tau)),
    **dict.fromkeys((_VELOCITY, _TO_VELOCITY), (0.1 * tau, 2.5e-4 * tau, 1e-5 * tau, tau)),
    **dict.fromkeys((_TORQUE, _TO_TORQUE, _MOST), (0.5, 1e-2, 1e-3, 1.0)),
    **dict.fromkeys((_KP, _KD), (1 / 127, 1 / 32767, 1 / 2147483647, 1.0)),
    _VOLTAGE: (0.5, 0.1, 1e-3, 1.0), _TEMPERATURE: (1.0, 0.1, 1e-3, 1.0), _WATCHDOG: (1e-2, 1e-3, 1e-6, 1.0),
}  # fmt: skip
_FAULT_NAMES = {
    _TIMEOUT: "no command within its watchdog", 32: "calibration", 33: "motor driver", 34: "over-voltage",
    35: "encoder", 36: "not configured", 37: "PWM overrun", 38: "hot", 39: "outside its limits",
    40: "under-voltage", 41: "configuration changed", 42: "commutation encoder", 43: "output encoder",
    44: "driver enable", 45: "stop position", 46: "timing", 47: "feedforward without acceleration",
    48: "invalid limits",
}  # fmt: skip


class Moteus:
    """One drive.

    Args:
        id: of the drive, 7 bits.
        host_id: to which it answers, 7 bits.
        ranges: what is never exceeded; kp and kd are those that the drive is configured with, at the output.
        watchdog_s: after which silence it stops following; goes with every command [s].
        registers: their type; int16 is in steps of 0.6 mrad, 1.6 mrad/s, 10 mN m and 1 ms.
    """

    name = "moteus"
    parameters: tuple[ParameterName, ...] = ("watchdog",)

    def __init__(
        self, id: int, host_id: int, ranges: Ranges, watchdog_s: float = 0.02,
        registers: Literal["int16", "float"] = "float",
    ) -> None:  # fmt: skip
        if not (0 <= id <= 0x7F and 0 <= host_id <= 0x7F) or id == host_id:
            raise FrameError(f"ids {id:#x} and {host_id:#x}: give two different ones of 7 bits")
        if not 1e-3 <= watchdog_s <= 30.0:  # 0 is the drive's own, no number none at all
            raise FrameError(f"a watchdog of {watchdog_s:g} s is outside 0.001 to 30 s")
        self.id, self.host_id, self.ranges, self.watchdog_s = id, host_id, ranges, watchdog_s
        self._kind = {"int16": 1, "float": 3}[registers]
        self.torque_step = _STEPS[_TO_TORQUE][1] if registers == "int16" else 1e-5
        self._query = head(READ, self._kind, _MODE, 4) + head(READ, 0, _VOLTAGE, 3)

    @property
    def exchange(self) -> tuple[Carried, ...]:
        """Return the frames of one exchange."""
        sent = self.command(Setpoint(0.0, 0.0, 0.0, 0.0, 0.0))
        answer = self.id << 8 | self.host_id
        said = 3 + 4 * (2, 4)[self._kind == 3] + 2 + 3  # heads, four registers, three of a byte
        return Carried(len(sent.data), True, True), Carried(len(padded(bytes(said))), answer > 0x7FF, True)

    @property
    def claims(self) -> frozenset[tuple[int, bool]]:
        """Return the identifiers of this drive, and whether they have 29 bits."""
        answer = self.id << 8 | self.host_id
        return frozenset({(_ANSWER | self.host_id << 8 | self.id, True), (answer, answer > 0x7FF)})

    # What a host needs.

    def explain(self, fault: int) -> str:
        """Return the name of a fault, by the number in the feedback."""
        return _FAULT_NAMES.get(fault, f"number {fault}")

    def command(self, setpoint: Setpoint) -> Frame:
        """Return the frame of a setpoint, which also asks for feedback.

        Raises:
            FrameError: not finite, outside the ranges, or with a larger part of kd than of kp: the drive
                takes that only as damping alone, with the whole kd, without torque and speed.
        """
        r, s = self.ranges, setpoint
        r.check(s)
        stiff, damped = s.kp / r.kp, s.kd / r.kd
        patience = packed(WRITE, {_WATCHDOG: self.watchdog_s}, self._kind, _STEPS)
        if s.kp == s.torque == s.velocity == 0.0 and damped == 1.0:
            return self._to_drive(packed(WRITE, {_MODE: _DAMPS}, 0, _STEPS) + patience + self._query)
        if damped > stiff * (1 + _ROUNDING):
            raise FrameError(
                f"kd of {s.kd:g} uses more of its range ({r.kd:g}) than kp of {s.kp:g} of its own ({r.kp:g})"
            )
        values = {_TO_POSITION: s.position, _TO_VELOCITY: s.velocity, _TO_TORQUE: s.torque, _KP: stiff,
                  _KD: damped, _MOST: r.torque}  # fmt: skip
        asked = packed(WRITE, values, self._kind, _STEPS) + patience
        return self._to_drive(packed(WRITE, {_MODE: _FOLLOWS}, 0, _STEPS) + asked + self._query)

    def act(self, action: Action) -> Frame:
        """Return the frame of an action; an empty setpoint enables the drive."""
        if action == "enable":
            return self.command(Setpoint(0.0, 0.0, 0.0, 0.0, 0.0))
        if action == "zero":
            return self._to_drive(packed(WRITE, {_OUTPUT: 0.0}, 3, _STEPS))
        return self._to_drive(packed(WRITE, {_MODE: _STOPPED}, 0, _STEPS) + self._query)

    def read(self, name: ParameterName) -> Frame:
        """Return the frame that asks for a parameter.

        Raises:
            FrameError: these drives do not tell it.
        """
        if name != "watchdog":
            raise FrameError(f"moteus drives do not report their {name}")
        return self._to_drive(head(READ, 3, _WATCHDOG, 1))

    def write(self, parameter: Parameter) -> Frame:
        """Return the frame that stops the drive and sets its watchdog; each command sets the watchdog anew.

        Raises:
            FrameError: another parameter, or another watchdog than the commands'.
        """
        if parameter != ("watchdog", self.watchdog_s):
            raise FrameError(f"this moteus cannot be set to a {parameter.name} of {parameter.value:g}")
        patience = packed(WRITE, {_WATCHDOG: self.watchdog_s}, self._kind, _STEPS)
        return self._to_drive(packed(WRITE, {_MODE: _STOPPED}, 0, _STEPS) + patience)

    def decode(self, frame: Frame) -> Feedback | Parameter | None:
        """Return the content of a frame of this drive; None if another's, or without motion or watchdog.

        Raises:
            FrameError: a frame of this drive that is cut off, no answer, or tells an error.
        """
        if frame.id != self.id << 8 | self.host_id:
            return None
        said = {at: value for what, at, value in subframes(frame.data, _STEPS) if _answers(what, at, value)}
        if _WATCHDOG in said:
            return Parameter("watchdog", said[_WATCHDOG])
        if not said.keys() >= {_MODE, _POSITION, _VELOCITY, _TORQUE}:
            return None
        mode = said[_MODE]
        fault = (
            int(said.get(_FAULT, 0)) or _FAULTY if mode == _FAULTY else _TIMEOUT if mode == _TIMEOUT else 0
        )
        motion = said[_POSITION], said[_VELOCITY], said[_TORQUE]
        return Feedback(*motion, said.get(_TEMPERATURE), mode in (_FOLLOWS, _DAMPS), fault)

    def asked(self, frame: Frame) -> Setpoint | Action | Read | None:
        """Return what the host commands this drive, as in a log; None if the frame is not for it."""
        if frame.id & ~_ANSWER != self.host_id << 8 | self.id:
            return None
        try:
            found = list(subframes(frame.data, _STEPS))
        except FrameError:
            return None
        told = {at: value for what, at, value in found if what == WRITE}
        if _OUTPUT in told:
            return "zero"
        mode = told.get(_MODE)
        if mode == _DAMPS:
            return Setpoint(0.0, 0.0, 0.0, self.ranges.kd, 0.0)
        if mode == _FOLLOWS:
            p, v, t = (told.get(at, 0.0) for at in (_TO_POSITION, _TO_VELOCITY, _TO_TORQUE))
            kp = told.get(_KP, 1.0)
            return Setpoint(p, v, kp * self.ranges.kp, min(told.get(_KD, 1.0), kp) * self.ranges.kd, t)
        if mode == _STOPPED:
            return "disable"
        return Read("watchdog") if (READ, _WATCHDOG) in {(what, at) for what, at, _ in found} else None

    def _to_drive(self, data: bytes) -> Frame:
        return Frame(_ANSWER | self.host_id << 8 | self.id, padded(data), True, fd=True)


def _answers(what: int, register: int, value: float) -> bool:
    """Whether a part of an answer is one; modes and faults that are no number are not."""
    if what != REPLY:
        raise FrameError(f"an answer with subframe {what:#x}")
    if register in (_MODE, _FAULT) and not isfinite(value):
        raise FrameError(f"register {register:#x} is not a number")
    return True
