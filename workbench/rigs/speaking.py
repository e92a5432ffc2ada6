"""Messages of virtual drives: the other side of the codec, or code that shares nothing with it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, cast

from workbench.can import Feedback, Frame, MotorTable, Parameter, Ranges, make_drive

from .moteus_drive import MoteusDrive
from .odrive_drive import OdriveDrive


class Speaker(Protocol):
    """Interface of a virtual drive on its bus."""

    @property
    def name(self) -> str:
        """Return the name of the protocol."""
        ...

    @property
    def ranges(self) -> Ranges:
        """Return its configured ranges."""
        ...

    @property
    def parameters(self) -> Sequence[str]:
        """Return the parameters that can be read."""
        ...

    def asked(self, frame: Frame) -> Any:
        """Return what a frame asks: setpoint, action, parameter, reading; one, several, or nothing."""
        ...

    def answer(self, feedback: Feedback) -> Frame | tuple[Frame, ...]:
        """Return its feedback."""
        ...

    def tell(self, parameter: Parameter) -> Frame:
        """Return the answer to a read parameter."""
        ...

    def confirm(self, parameter: Parameter) -> Frame | None:
        """Return the answer to a written parameter."""
        ...


def side_of(motor: MotorTable, own: tuple[float, float, float] | None = None) -> Speaker:
    """Return the virtual drive of a motor.

    Args:
        motor: what is configured.
        own: its ranges, where they are to be read from it.
    """
    drive = make_drive(motor, own)
    match motor.protocol:
        case "moteus":
            return MoteusDrive(motor.id, motor.reply_id, drive.ranges)
        case "odrive":
            ends = motor.endpoints
            numbers = (ends.watchdog_timeout, ends.enable_watchdog) if ends else (None, None)
            return OdriveDrive(motor.id, drive.ranges, *numbers)
    return cast(Speaker, drive)


def things(asked: Any) -> list[Any]:
    """Return what one frame asks, as a list."""
    return asked if isinstance(asked, list) else [] if asked is None else [asked]


def unasked(side: Speaker, feedback: Feedback, now: float) -> list[Frame]:
    """Return what a drive sends by itself, if it does so."""
    return side.unasked(feedback, now) if isinstance(side, OdriveDrive) else []
