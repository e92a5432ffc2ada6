"""How virtual drives speak: the codec's own other side, or one that shares no code with it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, cast

from workbench.can import Feedback, Frame, MotorTable, Parameter, Ranges, make_drive

from .moteus_drive import MoteusDrive
from .odrive_drive import OdriveDrive


class Speaker(Protocol):
    """What a drive hears and says."""

    @property
    def name(self) -> str:
        """Of the protocol."""
        ...

    @property
    def ranges(self) -> Ranges:
        """What it is configured with."""
        ...

    @property
    def parameters(self) -> Sequence[str]:
        """What can be read from it."""
        ...

    def asked(self, frame: Frame) -> Any:
        """What a frame asks: a setpoint, an action, a parameter, a look; one, several, or nothing."""
        ...

    def answer(self, feedback: Feedback) -> Frame | tuple[Frame, ...]:
        """What it says of itself when it was asked."""
        ...

    def tell(self, parameter: Parameter) -> Frame:
        """The answer to a parameter that was asked for."""
        ...

    def confirm(self, parameter: Parameter) -> Frame | None:
        """The answer to a parameter that was written."""
        ...


def side_of(motor: MotorTable, own: tuple[float, float, float] | None = None) -> Speaker:
    """The virtual drive of a motor.

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
    """What one frame asks, as a list."""
    return asked if isinstance(asked, list) else [] if asked is None else [asked]


def unasked(side: Speaker, feedback: Feedback, now: float) -> list[Frame]:
    """What a drive says by itself, if it is one that does."""
    return side.unasked(feedback, now) if isinstance(side, OdriveDrive) else []
