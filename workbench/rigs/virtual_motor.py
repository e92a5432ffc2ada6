"""A drive with its protocol: it follows setpoints while it is enabled and receives frames from its host."""

from __future__ import annotations

from workbench.can import Feedback, Frame, FrameError, Parameter, Read, Setpoint
from workbench.can.messages import burst

from .live import Look
from .speaking import Speaker, things, unasked

_AMBIENT, _WARMING, _COOLING = 25.0, 0.01, 60.0  # deg C, K/(s (N m)^2), s
_HOT = 110.0  # deg C, where it gives up
_LOST, _OVERHEATED = 0xD, 0xC  # as Damiao numbers them
_TELL_FAULTS = ("damiao", "moteus", "odrive")  # as virtual drives go


class VirtualMotor:
    """One drive; it is simulated once per row, like the control of a real drive.

    Args:
        axis: name of its axis.
        drive: its protocol, identifiers and ranges.
        sign, offset: of the axis over the drive.

    Attributes:
        enabled: whether it drives.
        dead: hears and says nothing, and drives nothing; for tests.
        parameters: its registers. The watchdog's factory setting is off.
        temperature: [deg C].
        heard: when it last heard a command [s].
        longest: the longest it drove without one [s].
    """

    def __init__(self, axis: str, drive: Speaker, sign: int = 1, offset: float = 0.0) -> None:
        self.axis, self.drive, self._sign, self._offset = axis, drive, sign, offset
        ranges = drive.ranges
        self.parameters: dict[str, float] = {
            "watchdog": 0.0, "mode": 1.0,
            "position": ranges.position, "velocity": ranges.velocity, "torque": ranges.torque,
        }  # fmt: skip
        self.enabled, self.dead, self.fault = False, False, 0
        self.temperature, self.heard, self.longest = _AMBIENT, 0.0, 0.0
        self._setpoint = Setpoint(0.0, 0.0, 0.0, 0.0, 0.0)
        self._inbox: list[Frame] = []
        self._answers: list[Parameter] = []
        self._confirmed: list[Parameter] = []
        self._speak = False

    def hear(self, frame: Frame) -> None:
        """Receive a frame from its bus."""
        if not self.dead:
            self._inbox.append(frame)

    def obey(self, now: float) -> None:
        """Apply what was received since the last row, unless that is too long ago."""
        for asked in [each for frame in self._inbox for each in things(self.drive.asked(frame))]:
            if isinstance(asked, Setpoint):
                self._setpoint, self.heard = asked, now
            elif isinstance(asked, Read):
                self._answers.append(Parameter(asked.name, self.parameters[asked.name]))
                continue
            elif isinstance(asked, Parameter):
                self.parameters[asked.name] = asked.value
                self._confirmed.append(asked)
                if self.drive.confirm(asked):
                    continue
            elif asked != "look":
                self._act(asked, now)
            self._speak = True
        self._inbox.clear()
        watchdog = self.parameters["watchdog"]
        if self.dead or (self.enabled and 0.0 < watchdog < now - self.heard):
            self.enabled, self.fault = False, _LOST
        if self.temperature > _HOT:
            self.enabled, self.fault = False, _OVERHEATED

    @property
    def has_heard(self) -> bool:
        """Return whether a frame is waiting."""
        return bool(self._inbox)

    @property
    def asked(self) -> bool:
        """Return whether an answer is due."""
        return self._speak

    def torque(self, look: Look) -> float:
        """Return its torque for its present readings; at the axis [N m]."""
        if not self.enabled:
            return 0.0
        s, q, w = self._setpoint, self._sign * (look[0] - self._offset), self._sign * look[1]
        most = self.drive.ranges.torque
        torque = s.torque + s.kp * (s.position - q) + s.kd * (s.velocity - w)
        return self._sign * min(max(torque, -most), most)

    def answer(self, look: Look, now: float, row: float) -> list[Frame]:
        """Return its feedback at the end of a row, and its temperature after a row of `row` [s]."""
        if self.enabled:
            self.longest = max(self.longest, now - self.heard)
        heat = _WARMING * look[2] ** 2 if self.enabled else 0.0
        self.temperature += row * (heat - (self.temperature - _AMBIENT) / _COOLING)
        if self.dead:
            return []
        said = [frame for p in self._confirmed if (frame := self.drive.confirm(p))]
        self._confirmed.clear()
        for parameter in self._answers:
            try:
                said.append(self.drive.tell(parameter))
            except FrameError:
                continue
        self._answers.clear()
        fault = self.fault if self.drive.name in _TELL_FAULTS else 0
        q, w, t = self._sign * (look[0] - self._offset), self._sign * look[1], self._sign * look[2]
        own = Feedback(q, w, t, self.temperature, self.enabled, fault)
        if self._speak:
            self._speak = False
            said += burst(self.drive.answer(own))
        return said + (unasked(self.drive, own, now) if row else [])

    def _act(self, action: str, now: float) -> None:
        if action == "enable" and not self.fault:
            self.enabled, self.heard = True, now
            self._setpoint = Setpoint(0.0, 0.0, 0.0, 0.0, 0.0)
        elif action == "disable":
            self.enabled = False
        elif action == "clear":
            self.enabled, self.fault = False, 0
