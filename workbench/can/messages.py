"""Messages between host and drive, independent of the protocol; SI, at the output of the drive."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Literal, NamedTuple

from .frame import Frame, FrameError
from .span import Span


@dataclass(frozen=True)
class Ranges:
    """Full scale of each field: -x to x, gains 0 to x.

    Published ranges contradict each other, so they carry their source.

    Attributes:
        position: [rad]. velocity: [rad/s]. torque: [N m]. kp: [N m/rad]. kd: [N m s/rad].
        source: where the numbers are from; ``"drive"`` where they are read from it.
    """

    position: float
    velocity: float
    torque: float
    kp: float
    kd: float
    source: str

    def check(self, setpoint: Setpoint) -> None:
        """Refuse values that the drive must not get.

        Raises:
            FrameError: a number that is not finite or outside, or a negative gain.
        """
        for name, value in zip(setpoint._fields, setpoint, strict=True):
            most = getattr(self, name)
            if not (isfinite(value) and abs(value) <= most and (value >= 0.0 or name[0] != "k")):
                raise FrameError(f"{name} of {value:g} is not within {most:g}")


class Setpoint(NamedTuple):
    """Command to a drive: torque + kp (position - q) + kd (velocity - w)."""

    position: float
    velocity: float
    kp: float
    kd: float
    torque: float


class Feedback(NamedTuple):
    """Feedback of a drive.

    Attributes:
        position, velocity, torque: [rad, rad/s, N m].
        temperature: hottest that it tells [deg C]; None where it tells none.
        enabled: whether it drives; None where it does not say.
        fault: 0 for none, else the protocol's own number.
    """

    position: float
    velocity: float
    torque: float
    temperature: float | None = None
    enabled: bool | None = None
    fault: int = 0


class Fault(NamedTuple):
    """A fault that a drive reports outside its feedback, with the number of the protocol."""

    number: int


#: What a drive is told to do, besides to follow a setpoint.
Action = Literal["enable", "disable", "zero", "clear"]

#: What can be read from a drive that lets itself be read; watchdog in seconds, 0 for none; mode 1 is that of
#: the setpoints above; the ends of its ranges.
ParameterName = Literal["watchdog", "mode", "position", "velocity", "torque"]


class Parameter(NamedTuple):
    """The value of a parameter, as an answer or to be written."""

    name: ParameterName
    value: float


class Read(NamedTuple):
    """A request for a parameter."""

    name: ParameterName


class Carried(NamedTuple):
    """A frame of an exchange with a drive, for the load of the bus.

    Attributes:
        length: bytes. extended, fd: as of `Frame`.
        hz: how often it comes by itself; 0 for once an exchange.
    """

    length: int
    extended: bool = False
    fd: bool = False
    hz: float = 0.0


def burst(frames: Frame | tuple[Frame, ...]) -> tuple[Frame, ...]:
    """Return the frames of one command: most protocols need one."""
    return (frames,) if isinstance(frames, Frame) else frames


class Fields(NamedTuple):
    """The five fields of a command, of which feedback uses three."""

    position: Span
    velocity: Span
    kp: Span
    kd: Span
    torque: Span

    def clipped(self, feedback: Feedback) -> list[int]:
        """Return raw position, velocity and torque, clipped to the ranges as drives do."""
        spans = self.position, self.velocity, self.torque
        return [span.clipped(value) for span, value in zip(spans, feedback[:3], strict=True)]


def fields(ranges: Ranges, bits: tuple[int, int, int, int, int], kept: int = 0) -> Fields:
    """Return fields of `bits` each; `kept` raw positions at the upper end are not used in commands."""
    p, v, kp, kd, t = bits
    return Fields(
        Span(-ranges.position, ranges.position, p, kept),
        Span(-ranges.velocity, ranges.velocity, v),
        Span(0.0, ranges.kp, kp),
        Span(0.0, ranges.kd, kd),
        Span(-ranges.torque, ranges.torque, t),
    )
