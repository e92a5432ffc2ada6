"""What hangs on which bus: one TOML file for buses, motors, limits and loop, checked before any motion."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, FiniteFloat, ValidationError

from workbench.core import InputError

from .clock import Clock
from .damiao import REGISTERS_ID, Damiao
from .frame import FrameError
from .imu import IMUS
from .messages import Ranges
from .mit import Mit
from .robstride import Robstride

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Drive = Mit | Damiao | Robstride


def _listed(value: Any) -> Any:
    return value if isinstance(value, list) else [value]


Gains = Annotated[list[NotNegative], BeforeValidator(_listed)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class RangesTable(_Table):
    """Full scale of the fields; with ``source = "drive"`` the first three may be left out and are read."""

    position: Positive | None = None
    velocity: Positive | None = None
    torque: Positive | None = None
    kp: Positive = 500.0
    kd: Positive = 5.0
    source: Annotated[str, Field(min_length=1)]


class LimitsTable(_Table):
    """What an axis must never leave, at the axis (behind sign and offset).

    Attributes:
        position: lowest and highest [rad]. velocity: [rad/s]. torque: [N m].
        torque_rate: fastest change of torque [N m/s]. temperature: [deg C].
    """

    position: tuple[FiniteFloat, FiniteFloat]
    velocity: Positive
    torque: Positive
    torque_rate: Positive = 5000.0
    temperature: Positive = 80.0


class MotorTable(_Table):
    """``[[motor]]``: one drive; q = sign (its position) + offset.

    Attributes:
        axis: name of the axis it turns.
        bus: name of its bus.
        protocol: which.
        id, reply_id: of its commands and its answers (robstride: the host's id).
        ranges, limits: see there.
        watchdog_s: after which silence the drive stops itself [s]; read back where the protocol allows.
        watchdog_source: who says so, where it cannot be read.
        sign, offset: of the axis over the drive.
        temperature_offset, length: of MIT answers.
    """

    axis: Annotated[str, Field(min_length=1)]
    bus: str
    protocol: Literal["mit", "damiao", "robstride"]
    id: int
    reply_id: int
    ranges: RangesTable
    limits: LimitsTable
    watchdog_s: Annotated[float, Field(ge=0.010, le=0.025)] = 0.020
    watchdog_source: str = ""
    sign: Literal[-1, 1] = 1
    offset: FiniteFloat = 0.0
    temperature_offset: FiniteFloat = -40.0
    length: Literal[6, 7, 8] = 8

    @property
    def reads_ranges(self) -> bool:
        """Whether the ranges are read from the drive."""
        return self.ranges.source == "drive"


class BusTable(_Table):
    """``[[bus]]``: a bus as python-can opens it; ``interface = "workbench"`` is the one between processes."""

    name: Annotated[str, Field(min_length=1)]
    interface: str
    channel: str
    bitrate: Annotated[int, Field(ge=10_000, le=1_000_000)] = 1_000_000
    options: dict[str, Any] = Field(default_factory=dict)


class MechanismTable(_Table):
    """``[[mechanism]]``: axes that a model's transmission couples, and its joints' limits [rad]."""

    model: str
    axes: list[str]
    joints: list[str] = []
    limits: list[tuple[FiniteFloat, FiniteFloat]] = []


class LoopTable(_Table):
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
    kp: Gains = [50.0]
    kd: Gains = [1.5]
    damping: Positive = 1.0
    soft_start_s: NotNegative = 1.0
    hold_s: NotNegative = 0.5


class ImuTable(_Table):
    """``[imu]``: the inertial unit of a base.

    Attributes:
        bus: name of its bus.
        protocol: a name in `workbench.can.imu.IMUS`.
        id: of its first frame.
        period_s: from one sample to the next [s].
    """

    bus: str
    protocol: str = "workbench"
    id: int
    period_s: Annotated[float, Field(ge=0.0005, le=0.02)] = 0.003


class BenchTable(_Table):
    """``[bench]``: virtual hardware.

    Attributes:
        rig: what virtual motors turn. ``legs``: each mechanism a leg on its stand, every other axis a lone
            actuator. ``quadruped``: abduction, hip and knee of fl, fr, rl and rr, under one trunk.
        time_scale: how many times slower than real time everything runs: for machines that hold processes up
            longer than a drive's watchdog waits.
    """

    rig: Literal["legs", "quadruped"] = "legs"
    time_scale: Annotated[float, Field(ge=1.0, le=1000.0)] = 1.0


class CanConfig(_Table):
    """The whole file; `machine` is the hash of the machine that policies must have been trained for."""

    format: Literal[1]
    name: str = "robot"
    machine: str = ""
    bus: Annotated[list[BusTable], Field(min_length=1)]
    motor: Annotated[list[MotorTable], Field(min_length=1)]
    mechanism: list[MechanismTable] = []
    loop: LoopTable = LoopTable()
    imu: ImuTable | None = None
    bench: BenchTable = BenchTable()
    source: Path | None = None

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes, in the order of the motors."""
        return tuple(motor.axis for motor in self.motor)

    @property
    def clock(self) -> Clock:
        """What every process that works on these buses takes its time from."""
        return Clock(self.bench.time_scale)

    def on(self, bus: str) -> list[MotorTable]:
        """The motors of a bus."""
        return [motor for motor in self.motor if motor.bus == bus]

    def gains(self) -> tuple[list[float], list[float]]:
        """kp and kd, one an axis."""
        n = len(self.motor)
        kp, kd = self.loop.kp, self.loop.kd
        return (kp * n if len(kp) == 1 else kp), (kd * n if len(kd) == 1 else kd)


def load_config(path: str | Path) -> CanConfig:
    """Read a configuration.

    Raises:
        InputError: a missing or malformed file, an unknown name, an identifier used twice, a limit that no
            frame can carry; the text names the key and the remedy.
    """
    path = Path(path)
    try:
        table = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
        config = CanConfig.model_validate(table).model_copy(update={"source": path})
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read ({reason})", file=path, remedy="check the path") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"is not valid TOML: {error}", file=path, remedy="correct that line") from error
    except ValidationError as error:
        raise _explain(error, path) from error
    for key, problem, remedy in _problems(config):
        raise InputError(problem, file=path, column=key, remedy=remedy)
    return config


def make_drive(motor: MotorTable, read: tuple[float, float, float] | None = None) -> Drive:
    """The drive of a motor.

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


def _problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    """Key, problem and remedy of everything that is wrong."""
    names = [bus.name for bus in c.bus]
    for name in sorted({n for n in names if names.count(n) > 1}):
        yield "bus.name", f"bus '{name}' stands twice", "give each bus its own name"
    for axis in sorted({a for a in c.axes if c.axes.count(a) > 1}):
        yield "motor.axis", f"axis '{axis}' stands twice", "give each motor its own axis"
    for motor in c.motor:
        yield from _motor_problems(motor, c)
    for bus in names:
        yield from _id_problems(c.on(bus))
    yield from _imu_problems(c)
    n = len(c.motor)
    for key, values in (("loop.kp", c.loop.kp), ("loop.kd", c.loop.kd)):
        if len(values) not in (1, n):
            yield key, f"has {len(values)} values for {n} axes", "give one, or one an axis"
    real = [bus.name for bus in c.bus if bus.interface != "workbench"]
    if c.bench.time_scale != 1.0 and real:
        remedy = 'remove it, or give every bus interface = "workbench"'
        yield "bench.time_scale", f"the drives on '{real[0]}' keep real time", remedy
    taken: list[str] = []
    for mechanism in c.mechanism:
        for axis in mechanism.axes:
            if axis not in c.axes or axis in taken:
                what = "is in two mechanisms" if axis in taken else "has no motor"
                yield "mechanism.axes", f"axis '{axis}' {what}", f"axes: {', '.join(c.axes)}"
            taken.append(axis)
        for key, values in (("joints", mechanism.joints), ("limits", mechanism.limits)):
            if values and len(values) != len(mechanism.axes):
                problem = f"has {len(values)} entries for {len(mechanism.axes)} axes"
                yield f"mechanism.{key}", problem, "give one an axis"


def _motor_problems(motor: MotorTable, c: CanConfig) -> Iterator[tuple[str, str, str]]:
    key, names, r, limits = f"motor '{motor.axis}'", [b.name for b in c.bus], motor.ranges, motor.limits
    if motor.bus not in names:
        yield f"{key}.bus", f"no bus is called '{motor.bus}'", f"buses: {', '.join(names)}"
    if motor.reads_ranges and motor.protocol != "damiao":
        remedy = "give position, velocity, torque, and who says so"
        yield f"{key}.ranges.source", f"{motor.protocol} drives do not tell their ranges", remedy
    for name in ("position", "velocity", "torque"):
        if getattr(r, name) is None and not motor.reads_ranges:
            yield f"{key}.ranges.{name}", "is missing", 'give it and its source, or source = "drive"'
    if motor.protocol == "mit" and not motor.watchdog_source:
        remedy = "set it with the vendor's tool and say where from: watchdog_source"
        yield f"{key}.watchdog_source", "an mit drive's watchdog cannot be read back", remedy
    if motor.watchdog_s < 3 * c.loop.period_s:
        problem = f"{1e3 * motor.watchdog_s:g} ms is less than three periods of {1e3 * c.loop.period_s:g} ms"
        yield f"{key}.watchdog_s", problem, "a lost frame would stop the drive: 10 to 25 ms"
    low, high = limits.position
    if low >= high:
        yield f"{key}.limits.position", f"{low:g} is not below {high:g}", "give lowest, highest"
    try:
        make_drive(motor)
    except FrameError as error:
        yield key, str(error), "correct the identifiers"
    yield from range_problems(motor, (r.position, r.velocity, r.torque), c)


def range_problems(
    motor: MotorTable, ranges: tuple[float | None, float | None, float | None], c: CanConfig
) -> Iterator[tuple[str, str, str]]:
    """Limits and gains of a motor that its ranges (None: not known yet) cannot carry."""
    key, limits = f"motor '{motor.axis}'", motor.limits
    position, velocity, torque = ranges
    far = max(abs(x - motor.offset) for x in limits.position)
    for name, wanted, room in (
        ("position", far, position), ("velocity", limits.velocity, velocity),
        ("torque", limits.torque, torque),
    ):  # fmt: skip
        if room is not None and wanted > room:
            problem = f"{wanted:g} is beyond the range of {room:g} of its frames"
            yield f"{key}.limits.{name}", problem, "lower the limit, or correct the ranges"
    kp, kd = (values[c.axes.index(motor.axis)] if len(values) > c.axes.index(motor.axis) else 0.0
              for values in c.gains())  # fmt: skip
    own = (("kp", kp, motor.ranges.kp), ("kd", kd, motor.ranges.kd)) if c.loop.pd == "drive" else ()
    for name, wanted, room in (*own, ("damping", c.loop.damping, motor.ranges.kd)):
        if wanted > room:
            yield f"loop.{name}", f"{wanted:g} is beyond the {room:g} of '{motor.axis}'", "lower it"


def _id_problems(motors: list[MotorTable]) -> Iterator[tuple[str, str, str]]:
    """Identifiers on one bus that two drives, or a drive and the host, would both use."""
    standard = [m for m in motors if m.protocol != "robstride"]
    commands: dict[int, str] = {REGISTERS_ID: "the registers"} if standard else {}
    for motor in standard:
        if motor.id in commands:
            problem = f"id {motor.id:#x} is used by {commands[motor.id]} too"
            yield f"motor '{motor.axis}'.id", problem, "give each drive of a bus its own"
        commands[motor.id] = f"'{motor.axis}'"
    for motor in standard:
        if motor.reply_id in commands:
            problem = f"{motor.reply_id:#x} is also where {commands[motor.reply_id]} is commanded"
            yield f"motor '{motor.axis}'.reply_id", problem, "no drive's answer may look like a command"
        mixed = {m.protocol for m in standard if m.reply_id == motor.reply_id}
        if len(mixed) > 1:
            problem = f"drives of {' and '.join(sorted(mixed))} answer on {motor.reply_id:#x}"
            yield f"motor '{motor.axis}'.reply_id", problem, "give each protocol its own"
    others = [m.id for m in motors if m.protocol == "robstride"]
    for id in sorted({i for i in others if others.count(i) > 1}):
        yield "motor.id", f"id {id:#x} is used twice", "give each drive of a bus its own"


def _imu_problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    if c.imu is None:
        return
    names = [bus.name for bus in c.bus]
    if c.imu.bus not in names:
        yield "imu.bus", f"no bus is called '{c.imu.bus}'", f"buses: {', '.join(names)}"
    if c.imu.protocol not in IMUS:
        yield "imu.protocol", f"no unit is called '{c.imu.protocol}'", f"known: {', '.join(IMUS)}"
        return
    try:
        ids = IMUS[c.imu.protocol](c.imu.id).ids
    except FrameError as error:
        yield "imu.id", str(error), "correct the identifier"
        return
    taken = {REGISTERS_ID: "the registers"}
    for motor in c.on(c.imu.bus):
        taken |= {motor.id: f"'{motor.axis}'", motor.reply_id: f"'{motor.axis}'"}
    for id in ids:
        if id in taken:
            yield "imu.id", f"id {id:#x} is used by {taken[id]} too", "choose two that are free"


def _explain(error: ValidationError, path: Path) -> InputError:
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        tables: dict[Any, type[_Table]] = {
            "bus": BusTable, "motor": MotorTable, "mechanism": MechanismTable, "loop": LoopTable,
            "ranges": RangesTable, "limits": LimitsTable, "bench": BenchTable, "imu": ImuTable,
        }  # fmt: skip
        inside = [part for part in first["loc"][:-1] if part in tables]
        known = tuple((tables[inside[-1]] if inside else CanConfig).model_fields)
        close = get_close_matches(str(first["loc"][-1]), known, n=1, cutoff=0.5)
        remedy = f"did you mean '{close[0]}'?" if close else f"known keys: {', '.join(known)}"
        return InputError("unknown key", file=path, column=key, remedy=remedy)
    if first["type"] == "missing":
        return InputError("is missing", file=path, column=key, remedy="add it")
    found = first["input"]
    shown = "nothing" if isinstance(found, float) and math.isnan(found) else repr(found)
    message = first["msg"][0].lower() + first["msg"][1:]
    return InputError(f"{message}, found {shown}", file=path, column=key, remedy="correct the value")
