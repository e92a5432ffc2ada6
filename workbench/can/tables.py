"""Tables of one robot: buses, motors, limits, loop and bench."""

from __future__ import annotations

from datetime import date
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, FiniteFloat

from .clock import Clock
from .damiao import Damiao
from .inputs import ImuTable, StopTable
from .messages import Ranges
from .mit import Mit
from .moteus import Moteus
from .odrive import Endpoints, Odrive
from .robstride import Robstride
from .table import NotNegative, Positive, Table

Drive = Mit | Damiao | Robstride | Moteus | Odrive


def _listed(value: Any) -> Any:
    return value if isinstance(value, list) else [value]


Gains = Annotated[list[NotNegative], BeforeValidator(_listed)]


class RangesTable(Table):
    """Full scale of the fields; with ``source = "drive"`` the first three may be read from the drive."""

    position: Positive | None = None
    velocity: Positive | None = None
    torque: Positive | None = None
    kp: Positive = 500.0
    kd: Positive = 5.0
    source: Annotated[str, Field(min_length=1)]


class LimitsTable(Table):
    """Limits of an axis, in axis coordinates (after sign and offset).

    Attributes:
        position: lowest and highest [rad]. velocity: [rad/s]. torque: [N m].
        torque_rate: fastest change of torque [N m/s]. temperature: [deg C].
    """

    position: tuple[FiniteFloat, FiniteFloat]
    velocity: Positive
    torque: Positive
    torque_rate: Positive = 5000.0
    temperature: Positive = 80.0


class EndpointsTable(Table):
    """``endpoints`` of an odrive: their numbers in its firmware's ``flat_endpoints.json``.

    Attributes:
        watchdog_timeout, enable_watchdog: of ``axis0.config``.
    """

    watchdog_timeout: Annotated[int, Field(ge=0, le=0xFFFF)]
    enable_watchdog: Annotated[int, Field(ge=0, le=0xFFFF)]


class MotorTable(Table):
    """``[[motor]]``: one drive; q = sign (its position) + offset.

    Attributes:
        axis: name of the axis it turns.
        bus: name of its bus.
        protocol: which.
        id, reply_id: of its commands and its answers (robstride, moteus: the host's id; odrive: none).
        ranges, limits: see there.
        watchdog_s: after which silence the drive stops itself [s]; read back where the protocol allows.
        watchdog_source: who says so, where it cannot be read.
        watchdog_tested: the day on which a person saw it stop without its host, where it cannot be read.
        sign, offset: of the axis over the drive.
        temperature_offset, length: of MIT answers.
        registers: what a moteus is told and asked in.
        endpoints: of an odrive; without them its watchdog cannot be read back.
    """

    axis: Annotated[str, Field(min_length=1)]
    bus: str
    protocol: Literal["mit", "damiao", "robstride", "moteus", "odrive"]
    id: int
    reply_id: int = 0
    ranges: RangesTable
    limits: LimitsTable
    watchdog_s: Annotated[float, Field(ge=0.010, le=0.025)] = 0.020
    watchdog_source: str = ""
    watchdog_tested: date | None = None
    sign: Literal[-1, 1] = 1
    offset: FiniteFloat = 0.0
    temperature_offset: FiniteFloat = -40.0
    length: Literal[6, 7, 8] = 8
    registers: Literal["int16", "float"] = "float"
    endpoints: EndpointsTable | None = None

    @property
    def tells_watchdog(self) -> bool:
        """Return whether the watchdog can be read back."""
        return self.protocol != "mit" and (self.protocol != "odrive" or self.endpoints is not None)

    @property
    def reads_ranges(self) -> bool:
        """Whether the ranges are read from the drive."""
        return self.ranges.source == "drive"


class BusTable(Table):
    """``[[bus]]``: a bus as python-can opens it; ``interface = "workbench"`` is the one between processes.

    ``data_bitrate`` makes it a bus of CAN-FD frames, whose data are sent at that rate [bit/s].
    """

    name: Annotated[str, Field(min_length=1)]
    interface: str
    channel: str
    bitrate: Annotated[int, Field(ge=10_000, le=1_000_000)] = 1_000_000
    data_bitrate: Annotated[int, Field(ge=10_000, le=8_000_000)] | None = None
    options: dict[str, Any] = Field(default_factory=dict)


class MechanismTable(Table):
    """``[[mechanism]]``: axes that a transmission couples (its rows, or a model's); joints' limits [rad]."""

    model: str = ""
    axes: list[str]
    transmission: list[list[FiniteFloat]] = Field(default_factory=list)
    joints: list[str] = Field(default_factory=list)
    limits: list[tuple[FiniteFloat, FiniteFloat]] = Field(default_factory=list)


class LoopTable(Table):
    """``[loop]``: its timing, and who closes the position loop.

    Attributes:
        period_s: of the loop [s].
        polls: exchanges a period; more than one logs finer and sends the same setpoint again.
        policy_every: periods from one action to the next.
        pd: ``host``: tau_p = J^-T tau_s, drives get torque alone; ``drive``: each drive closes its own.
        kp, kd: of joints (host) or axes (drive), one or one each [N m/rad, N m s/rad].
        damping: what an axis damps with when nothing else is to be done [N m s/rad].
        soft_start_s: over which torque and references fade in [s].
        hold_s: how long a policy's posture is held before the policy begins [s].
    """

    period_s: Annotated[float, Field(ge=0.001, le=0.02)] = 0.003
    polls: Annotated[int, Field(ge=1, le=10)] = 1
    policy_every: Annotated[int, Field(ge=1)] = 6
    pd: Literal["host", "drive"] = "host"
    kp: Gains = Field(default=[50.0])
    kd: Gains = Field(default=[1.5])
    damping: Positive = 1.0
    soft_start_s: NotNegative = 1.0
    hold_s: NotNegative = 0.5


class BenchTable(Table):
    """``[bench]``: virtual hardware.

    Attributes:
        rig: what virtual motors turn. ``legs``: each mechanism a leg on its stand, every other axis a lone
            actuator. ``quadruped``: abduction, hip and knee of fl, fr, rl and rr, under one trunk.
        time_scale: how many times slower than real time everything runs: for machines that hold processes up
            longer than a drive's watchdog waits.
    """

    rig: Literal["legs", "quadruped"] = "legs"
    time_scale: Annotated[float, Field(ge=1.0, le=1000.0)] = 1.0


class CanConfig(Table):
    """The whole file; `machine` is the hash of the machine that policies must have been trained for."""

    format: Literal[1]
    name: str = "robot"
    machine: str = ""
    bus: Annotated[list[BusTable], Field(min_length=1)]
    motor: Annotated[list[MotorTable], Field(min_length=1)]
    mechanism: list[MechanismTable] = Field(default_factory=list)
    loop: LoopTable = LoopTable()
    imu: ImuTable | None = None
    stop: StopTable | None = None
    bench: BenchTable = BenchTable()
    source: Path | None = None

    @property
    def axes(self) -> tuple[str, ...]:
        """Return the names of the axes, in the order of the motors."""
        return tuple(motor.axis for motor in self.motor)

    @property
    def clock(self) -> Clock:
        """Return the clock of all processes on these buses."""
        return Clock(self.bench.time_scale)

    def on(self, bus: str) -> list[MotorTable]:
        """Return the motors of a bus."""
        return [motor for motor in self.motor if motor.bus == bus]

    def gains(self) -> tuple[list[float], list[float]]:
        """Return kp and kd, one per axis."""
        n = len(self.motor)
        kp, kd = self.loop.kp, self.loop.kd
        return (kp * n if len(kp) == 1 else kp), (kd * n if len(kd) == 1 else kd)


def make_drive(motor: MotorTable, read: tuple[float, float, float] | None = None) -> Drive:
    """Return the drive of a motor.

    Args:
        motor: what is configured.
        read: position, velocity and torque range read from it, where they are to be read. Without them a
            drive that is to be asked for its ranges can be asked, but not commanded.

    Raises:
        FrameError: identifiers or ranges that the protocol cannot have.
    """
    r = motor.ranges
    # a range of a millionth cannot carry a command: one that is sent before it is known raises
    known = read or (r.position or 1e-6, r.velocity or 1e-6, r.torque or 1e-6)
    ranges = Ranges(*known, r.kp, r.kd, r.source)
    match motor.protocol:
        case "mit":
            return Mit(motor.id, motor.reply_id, ranges, motor.temperature_offset, motor.length)
        case "damiao":
            return Damiao(motor.id, motor.reply_id, ranges)
        case "robstride":
            return Robstride(motor.id, motor.reply_id, ranges)
        case "moteus":
            return Moteus(motor.id, motor.reply_id, ranges, motor.watchdog_s, motor.registers)
        case "odrive":
            ends = motor.endpoints
            numbers = Endpoints(ends.watchdog_timeout, ends.enable_watchdog) if ends else None
            return Odrive(motor.id, ranges, numbers)
