"""Errors of a configuration whose single values are valid: names, identifiers, ranges, loads."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import date

import numpy as np

from .damiao import REGISTERS_ID
from .frame import FrameError
from .imu import IMUS
from .moteus import Moteus
from .odrive import Odrive
from .tables import CanConfig, MechanismTable, MotorTable, make_drive


def problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    """Return key, problem and remedy of everything that is wrong."""
    names = [bus.name for bus in c.bus]
    for name in sorted({n for n in names if names.count(n) > 1}):
        yield "bus.name", f"bus '{name}' is given twice", "give each bus its own name"
    for axis in sorted({a for a in c.axes if c.axes.count(a) > 1}):
        yield "motor.axis", f"axis '{axis}' is given twice", "give each motor its own axis"
    for motor in c.motor:
        yield from _motor_problems(motor, c)
    for bus in names:
        yield from _id_problems(c.on(bus))
    yield from _flexible_problems(c)
    yield from _imu_problems(c)
    yield from _stop_problems(c)
    n = len(c.motor)
    for key, values in (("loop.kp", c.loop.kp), ("loop.kd", c.loop.kd)):
        if len(values) not in (1, n):
            yield key, f"has {len(values)} values for {n} axes", "give one, or one per axis"
    real = [bus.name for bus in c.bus if bus.interface != "workbench"]
    if c.bench.time_scale != 1.0 and real:
        remedy = 'remove it, or give every bus interface = "workbench"'
        yield "bench.time_scale", f"the bus '{real[0]}' has real drives, which run in real time", remedy
    taken: list[str] = []
    for mechanism in c.mechanism:
        for axis in mechanism.axes:
            if axis not in c.axes or axis in taken:
                what = "is in two mechanisms" if axis in taken else "has no motor"
                yield "mechanism.axes", f"axis '{axis}' {what}", f"axes: {', '.join(c.axes)}"
            taken.append(axis)
        yield from _transmission_problems(mechanism)
        for key, values in (("joints", mechanism.joints), ("limits", mechanism.limits)):
            if values and len(values) != len(mechanism.axes):
                problem = f"has {len(values)} entries for {len(mechanism.axes)} axes"
                yield f"mechanism.{key}", problem, "give one per axis"


def _transmission_problems(mechanism: MechanismTable) -> Iterator[tuple[str, str, str]]:
    rows, n = mechanism.transmission, len(mechanism.axes)
    if not rows and not mechanism.model:
        yield "mechanism.model", "is missing", "name a model, or write the transmission's rows"
    elif rows and (len(rows) != n or any(len(row) != n for row in rows)):
        yield (
            "mechanism.transmission",
            f"is not a table of {n} rows of {n}",
            "give one row per axis, q_p = J q_s",
        )
    elif rows and abs(np.linalg.det(np.array(rows))) < 1e-6:
        yield "mechanism.transmission", "has no inverse", "correct its rows: q_p = J q_s"


def _motor_problems(motor: MotorTable, c: CanConfig) -> Iterator[tuple[str, str, str]]:
    key, r, limits = f"motor '{motor.axis}'", motor.ranges, motor.limits
    yield from _unknown_bus(c, f"{key}.bus", motor.bus)
    if motor.reads_ranges and motor.protocol != "damiao":
        remedy = "give position, velocity, torque, and who says so"
        yield f"{key}.ranges.source", f"{motor.protocol} drives do not report their ranges", remedy
    for name in ("position", "velocity", "torque"):
        if getattr(r, name) is None and not motor.reads_ranges:
            yield f"{key}.ranges.{name}", "is missing", 'give it and its source, or source = "drive"'
    if motor.protocol in ("mit", "damiao", "robstride") and "reply_id" not in motor.model_fields_set:
        yield f"{key}.reply_id", "is missing", "give the identifier of its answers (robstride: the host's id)"
    if motor.endpoints and motor.protocol != "odrive":
        yield f"{key}.endpoints", f"a {motor.protocol} drive has none", "remove them"
    if not motor.tells_watchdog and not motor.watchdog_source:
        remedy = "set it with the vendor's tool, and state where it is set: watchdog_source"
        if motor.protocol == "odrive":
            remedy += "; or give its firmware's endpoints"
        problem = f"the watchdog of this {motor.protocol} drive cannot be read back"
        yield f"{key}.watchdog_source", problem, remedy
    if motor.watchdog_tested and motor.watchdog_tested > date.today():
        problem = f"{motor.watchdog_tested} is in the future"
        yield f"{key}.watchdog_tested", problem, "write the day on which it was seen to stop"
    if motor.watchdog_s < 3 * c.loop.period_s:
        problem = f"{1e3 * motor.watchdog_s:g} ms is less than three periods of {1e3 * c.loop.period_s:g} ms"
        yield f"{key}.watchdog_s", problem, "a lost frame would stop the drive: 10 to 25 ms"
    low, high = limits.position
    if low >= high:
        yield f"{key}.limits.position", f"{low:g} is not below {high:g}", "give lowest, highest"
    try:
        make_drive(motor)
    except FrameError as error:
        yield key, str(error), "correct identifiers or ranges"
    yield from range_problems(motor, (r.position, r.velocity, r.torque), c)


def range_problems(
    motor: MotorTable, ranges: tuple[float | None, float | None, float | None], c: CanConfig
) -> Iterator[tuple[str, str, str]]:
    """Return limits and gains of a motor that do not fit into its ranges (None: not known yet)."""
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
            yield f"loop.{name}", f"{wanted:g} is more than '{motor.axis}' can take, {room:g}", "lower it"


def _imu_problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    if c.imu is None:
        return
    yield from _unknown_bus(c, "imu.bus", c.imu.bus)
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
        taken |= dict.fromkeys(_claimed(motor), f"'{motor.axis}'")
    for id in ids:
        if id in taken:
            yield "imu.id", f"id {id:#x} is used by {taken[id]} too", "choose some that are free"


def _unknown_bus(c: CanConfig, where: str, name: str) -> Iterator[tuple[str, str, str]]:
    names = [bus.name for bus in c.bus]
    if name not in names:
        yield where, f"no bus is called '{name}'", f"buses: {', '.join(names)}"


def _stop_problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    if c.stop is None:
        return
    if not (c.stop.bus or c.stop.chip):
        yield "stop", "names no button", "give bus and id, or chip and line"
    if c.stop.chip and "line" not in c.stop.model_fields_set:
        yield "stop.line", "is missing", "give the number of the line on its chip"
    if not c.stop.bus:
        return
    if c.stop.id is None:
        yield "stop.id", "is missing", "give the identifier of the button's frame"
        return
    yield from _unknown_bus(c, "stop.bus", c.stop.bus)
    taken = {REGISTERS_ID} | {id for motor in c.on(c.stop.bus) for id in _claimed(motor)}
    if c.imu and c.imu.bus == c.stop.bus and c.imu.protocol in IMUS:
        taken |= set(IMUS[c.imu.protocol](c.imu.id).ids)
    if c.stop.id in taken:
        yield "stop.id", f"id {c.stop.id:#x} is used by another", "choose one that is free"


def _id_problems(motors: list[MotorTable]) -> Iterator[tuple[str, str, str]]:
    """Identifiers on one bus that two drives, or a drive and the host, would both use."""
    standard = [m for m in motors if m.protocol in ("mit", "damiao")]
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
    for motor in motors:
        if motor.protocol not in ("moteus", "odrive"):
            continue
        others = [m for m in motors if m is not motor]
        for other in others:
            shared = _claimed(motor) & _claimed(other)
            if shared:
                problem = f"'{other.axis}' uses {min(shared):#x} too"
                yield f"motor '{motor.axis}'.id", problem, "give each drive of a bus its own"


def _claimed(motor: MotorTable) -> frozenset[int]:
    """The 11-bit identifiers that a drive, or its host, uses; impossible ones are left out."""
    try:
        drive = make_drive(motor)
    except FrameError:
        return frozenset()
    if isinstance(drive, Moteus | Odrive):
        return frozenset(id for id, extended in drive.claims if not extended)
    return frozenset({motor.id, motor.reply_id})


def _flexible_problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    """What CAN-FD, moteus and ODrive drives require."""
    for bus in c.bus:
        key, own = f"bus '{bus.name}'", {motor.protocol for motor in c.on(bus.name)}
        if bus.data_bitrate and bus.data_bitrate < bus.bitrate:
            problem = f"{bus.data_bitrate} is slower than the arbitration rate {bus.bitrate}"
            yield f"{key}.data_bitrate", problem, "correct one of them"
        if "moteus" not in own:
            continue
        if not bus.data_bitrate:
            problem = "moteus drives speak CAN-FD"
            yield f"{key}.data_bitrate", problem, "give the rate of its data, as 5_000_000"
        if others := own - {"moteus"}:
            problem = f"{', '.join(sorted(others))} drives treat CAN-FD frames as errors"
            yield f"{key}.data_bitrate", problem, "put moteus drives on a bus of their own"
    kds = dict(zip(c.axes, c.gains()[1], strict=False))
    for motor in c.motor:
        key, kd = f"motor '{motor.axis}'", motor.ranges.kd
        if motor.protocol == "odrive" and c.loop.pd == "drive" and kds.get(motor.axis, 1.0) <= 0.0:
            yield "loop.kd", f"'{motor.axis}' needs damping to have stiffness", "give more than 0"
        if motor.protocol != "moteus":
            continue
        if c.loop.pd == "drive":
            problem = (
                f"'{motor.axis}' cannot use a larger share of its range for kd than for kp, because kp "
                "fades in"
            )
            yield "loop.pd", problem, 'write pd = "host"'
        if c.loop.damping != kd:
            problem = f"a moteus damps with its whole kd of {kd:g}, not with {c.loop.damping:g}"
            yield f"{key}.ranges.kd", problem, "make loop.damping, ranges.kd and the drive's own the same"
