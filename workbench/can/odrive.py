"""ODrive drives: CAN Simple, as far as a loop needs it, by the table ``odrive.dbc`` beside this file.

Identifiers are node (6 bits) and message (5 bits). What a drive knows is asked for by a remote frame, or it
says so by itself: state and errors (``heartbeat_msg_rate_ms``, 10 here) and temperatures
(``temperature_msg_rate_ms``, 100 here). Turns there, radians here.

Its cascade is torque + vel_gain (vel + pos_gain (p - q) - w), so that kd is vel_gain and kp their product.
Every setpoint brings its gains: what a lost frame leaves undone the next exchange does. Parameters are
endpoints, whose numbers differ from firmware to firmware: a configuration has to name them.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from functools import lru_cache
from math import isfinite, tau
from pathlib import Path
from typing import Any, NamedTuple

from .frame import Frame, FrameError
from .messages import Action, Carried, Feedback, Parameter, ParameterName, Ranges, Read, Setpoint

TABLE = Path(__file__).with_name("odrive.dbc")
_IDLE, _DRIVES, _BY_POSITION, _AT_ONCE = 1, 8, 3, 1
_READ, _WRITE = 0, 1
_MOST = 32.767  # rev/s and N m of a setpoint
_PATIENCE = 12, 400  # feedbacks without a word of state, and of temperature
_FAULTS = {
    0: "not started", 1: "system", 2: "timing", 3: "no estimate", 4: "bad configuration", 5: "gate driver",
    6: "no input", 8: "over-voltage", 9: "under-voltage", 10: "over-current of the supply",
    11: "too much current fed back", 12: "over-current", 13: "hot motor", 14: "hot MOSFET",
    15: "too fast", 16: "outside its limits", 24: "no command within its watchdog", 25: "emergency stop",
    26: "encoder slipped", 27: "brake resistor", 28: "no thermistor", 30: "calibration",
}  # fmt: skip


class Endpoints(NamedTuple):
    """Numbers of ``axis0.config.watchdog_timeout`` and ``axis0.config.enable_watchdog``."""

    timeout: int
    enable: int


class Odrive:
    """One drive.

    What it says comes in several frames, so that one object hears one drive.

    Args:
        id: of the node, 6 bits.
        ranges: what is never exceeded.
        endpoints: None where its firmware's are not known: its watchdog cannot be asked for then.
    """

    name = "odrive"
    torque_step = 1e-3

    def __init__(self, id: int, ranges: Ranges, endpoints: Endpoints | None = None) -> None:
        if not 0 <= id < 0x3F:
            raise FrameError(f"id {id:#x}: a node has 0 to 0x3E")
        for name, most in (("torque", _MOST), ("velocity", _MOST * tau)):
            if getattr(ranges, name) > most:
                raise FrameError(
                    f"no frame carries a {name} of {getattr(ranges, name):g}: {most:.4g} at most"
                )
        self.id, self.ranges, self._endpoints = id, ranges, endpoints
        self.parameters: tuple[ParameterName, ...] = ("watchdog",) if endpoints else ()
        self._state: tuple[int, int] | None = None  # error and state
        self._hot: float | None = None
        self._without = [0, 0]  # feedbacks since the last word of state, and of temperature
        self._motion: tuple[float, float] | None = None
        self._told: dict[int, int] = {}  # endpoint -> raw value
        self._gains: dict[str, float] = {}

    @property
    def exchange(self) -> tuple[Carried, ...]:
        """Return the frames of one exchange, and those that the drive sends by itself."""
        own = Carried(8, hz=100.0), Carried(8, hz=10.0)
        return (*(Carried(8),) * 3, *(Carried(0),) * 2, *(Carried(8),) * 2, *own)

    @property
    def claims(self) -> frozenset[tuple[int, bool]]:
        """Return the identifiers of this drive, and whether they have 29 bits."""
        return frozenset((self.id << 5 | message, False) for message in range(32))

    # What a host needs.

    def explain(self, fault: int) -> str:
        """Return the names of the faults whose bits are set."""
        return ", ".join(name for bit, name in _FAULTS.items() if fault >> bit & 1) or f"number {fault}"

    def command(self, setpoint: Setpoint) -> tuple[Frame, ...]:
        """Return the frames of a setpoint, which also ask for feedback.

        Raises:
            FrameError: not finite, outside the ranges, or with stiffness but no damping.
        """
        s, r = setpoint, self.ranges
        r.check(s)
        if s.kp > 0.0 and s.kd <= 0.0:
            raise FrameError("an odrive needs damping (kd above 0) to have stiffness (kp)")
        stiff = s.kp / s.kd if s.kp else 0.0
        return (
            self._frame("set_position_gain", gain=stiff),
            self._frame("set_velocity_gains", gain=s.kd * tau, integrator=0.0),
            self._frame("set_input", position=s.position / tau, velocity=s.velocity / tau, torque=s.torque),
            *self._asks(),
        )

    def act(self, action: Action) -> tuple[Frame, ...]:
        """Return the frames of an action."""
        match action:
            case "enable":
                mode = self._frame("set_mode", control=_BY_POSITION, input=_AT_ONCE)
                return mode, self._frame("set_state", state=_DRIVES)
            case "disable":
                return self._frame("set_state", state=_IDLE), *self._asks()
            case "zero":
                return (self._frame("set_position", position=0.0),)
        return (self._frame("clear_errors", blink=0),)

    def read(self, name: ParameterName) -> tuple[Frame, ...]:
        """Return the frames that ask for a parameter.

        Raises:
            FrameError: it does not tell it.
        """
        if name != "watchdog" or self._endpoints is None:
            raise FrameError(f"this odrive does not report its {name}")
        self._told.clear()
        ask = [self._frame("ask_parameter", what=_READ, endpoint=at, value=0) for at in self._endpoints]
        return tuple(frame._replace(data=frame.data[:4]) for frame in ask)

    def write(self, parameter: Parameter) -> tuple[Frame, ...]:
        """Return the frames that set a parameter until the drive is switched off.

        Raises:
            FrameError: it has none of that name, or cannot hold that number.
        """
        if parameter.name != "watchdog" or self._endpoints is None:
            raise FrameError(f"this odrive's {parameter.name} cannot be set")
        if not (isfinite(parameter.value) and parameter.value > 0.0):
            raise FrameError(f"a watchdog of {parameter.value:g} s cannot be sent")
        (raw,) = struct.unpack("<I", struct.pack("<f", parameter.value))
        at = self._endpoints
        enable = self._frame("ask_parameter", what=_WRITE, endpoint=at.enable, value=1)
        timeout = self._frame("ask_parameter", what=_WRITE, endpoint=at.timeout, value=raw)
        return timeout, enable._replace(data=enable.data[:5])

    def decode(self, frame: Frame) -> Feedback | Parameter | None:
        """Return the feedback of this drive as soon as its motion and torque are known; otherwise None.

        Raises:
            FrameError: a frame of this drive with a length that it does not have.
        """
        said = _messages().get(frame.id & 0x1F)
        if frame.extended or frame.remote or frame.fd or frame.id >> 5 != self.id or said is None:
            return None
        if said.senders != ["drive"]:
            return None
        if len(frame.data) != said.length and not (said.name == "tell_parameter" and len(frame.data) > 4):
            raise FrameError(f"answer of {len(frame.data)} bytes on {frame.id:#x}")
        told: Any = said.decode(frame.data.ljust(8, b"\0"), decode_choices=False)
        match said.name:
            case "heartbeat":
                self._state, self._without[0] = (told["error"], told["state"]), 0
            case "temperatures":
                known = [t for t in told.values() if isfinite(t)]
                self._hot, self._without[1] = max(known, default=None), 0
            case "motion":
                self._motion = told["position"] * tau, told["velocity"] * tau
            case "torques":
                return self._feedback(told["estimate"])
            case "tell_parameter":
                self._told[told["endpoint"]] = told["value"]
                return self._watchdog()
        return None

    def asked(self, frame: Frame) -> Setpoint | Action | Read | None:
        """Return what the host commands this drive, as in a log; None if the frame is not for it."""
        said = _messages().get(frame.id & 0x1F)
        if frame.extended or frame.remote or frame.fd or frame.id >> 5 != self.id or said is None:
            return None
        if said.senders != ["host"] or len(frame.data) > said.length:
            return None
        told: Any = said.decode(frame.data.ljust(said.length, b"\0"), decode_choices=False)
        match said.name:
            case "set_position_gain" | "set_velocity_gains":
                self._gains[said.name] = told["gain"]
            case "set_input" if len(self._gains) == 2:
                stiff, kd = self._gains["set_position_gain"], self._gains["set_velocity_gains"] / tau
                p, v = told["position"] * tau, told["velocity"] * tau
                return Setpoint(p, v, stiff * kd, kd, told["torque"])
            case "set_state":
                return "enable" if told["state"] == _DRIVES else "disable"
            case "clear_errors":
                return "clear"
            case "set_position":
                return "zero"
            case "ask_parameter" if told["what"] == _READ:
                return Read("watchdog")
        return None

    def _feedback(self, torque: float) -> Feedback | None:
        """What is known when its torque comes: nothing of a drive that no longer tells its state."""
        motion, self._motion = self._motion, None
        if motion is None or self._state is None or self._hot is None:
            return None
        self._without = [count + 1 for count in self._without]
        if any(count > most for count, most in zip(self._without, _PATIENCE, strict=True)):
            return None
        error, state = self._state
        return Feedback(*motion, torque, self._hot, state == _DRIVES, error)

    def _watchdog(self) -> Parameter | None:
        """The watchdog, once time and switch are told; 0 where it is off."""
        if self._endpoints is None or not self._told.keys() >= set(self._endpoints):
            return None
        raw, on = self._told[self._endpoints.timeout], self._told[self._endpoints.enable]
        (timeout,) = struct.unpack("<f", struct.pack("<I", raw))
        return Parameter("watchdog", timeout if on & 0xFF else 0.0)

    def _asks(self) -> tuple[Frame, Frame]:
        motion, torques = _by_name()["motion"].frame_id, _by_name()["torques"].frame_id
        return self._remote(motion), self._remote(torques)

    def _remote(self, message: int) -> Frame:
        return Frame(self.id << 5 | message, b"", remote=True)

    def _frame(self, name: str, **values: float) -> Frame:
        message = _by_name()[name]
        return Frame(self.id << 5 | message.frame_id, bytes(message.encode(values, strict=False)))


@lru_cache(maxsize=1)
def _by_name() -> Mapping[str, Any]:
    from cantools.database import load_file  # takes a while to load, and only these drives need it

    return {message.name: message for message in load_file(TABLE, strict=True).messages}  # type: ignore[union-attr]


@lru_cache(maxsize=1)
def _messages() -> Mapping[int, Any]:
    return {message.frame_id: message for message in _by_name().values()}
