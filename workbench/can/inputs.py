"""Other devices on a bus: an inertial unit, an emergency stop."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .table import Table


class ImuTable(Table):
    """``[imu]``: the inertial unit of a base.

    Attributes:
        bus: name of its bus.
        protocol: a name in `workbench.can.imu.IMUS`.
        id: of its first frame.
        period_s: from one sample to the next [s].
        fall_s: over which what carries the base is averaged [s]: so long a free fall damps.
        tilt: of the base against gravity, beyond which everything damps [rad]; else the policy's.
    """

    bus: str
    protocol: str = "workbench"
    id: int
    period_s: Annotated[float, Field(ge=0.0005, le=0.02)] = 0.003
    fall_s: Annotated[float, Field(ge=0.05, le=1.0)] = 0.12
    tilt: Annotated[float, Field(gt=0.0, le=3.2)] | None = None


class StopTable(Table):
    """``[stop]``: an emergency stop on a bus, on a line of the computer, or on both.

    On a bus it says that motion is permitted: first byte 1, standard id. The line is high for that.

    Attributes:
        bus: name of its bus; empty without one.
        id: of its frame.
        silent_s: how long it may say nothing there before that is a press [s].
        chip: of its line, as ``/dev/gpiochip0``; empty without one.
        line: its number.
    """

    bus: str = ""
    id: Annotated[int, Field(ge=0, le=0x7FF)] | None = None
    chip: str = ""
    line: Annotated[int, Field(ge=0)] = 0
    silent_s: Annotated[float, Field(ge=0.01, le=1.0)] = 0.1
