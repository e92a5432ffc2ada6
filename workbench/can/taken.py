"""Identifiers on a bus that two drives, or a drive and its host, would both use."""

from __future__ import annotations

from collections.abc import Iterator

from .damiao import REGISTERS_ID
from .frame import FrameError
from .moteus import Moteus
from .odrive import Odrive
from .tables import MotorTable, make_drive


def id_problems(motors: list[MotorTable]) -> Iterator[tuple[str, str, str]]:
    """Return identifiers on one bus that two drives, or a drive and the host, would both use."""
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
            shared = claimed(motor) & claimed(other)
            if shared:
                problem = f"'{other.axis}' uses {min(shared):#x} too"
                yield f"motor '{motor.axis}'.id", problem, "give each drive of a bus its own"


def claimed(motor: MotorTable) -> frozenset[int]:
    """Return the 11-bit identifiers that a drive, or its host, uses; impossible ones are left out."""
    try:
        drive = make_drive(motor)
    except FrameError:
        return frozenset()
    if isinstance(drive, Moteus | Odrive):
        return frozenset(id for id, extended in drive.claims if not extended)
    return frozenset({motor.id, motor.reply_id})
