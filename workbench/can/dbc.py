"""A DBC file of the drives, as far as a DBC can describe them.

Answers on one identifier are told apart by the drive's id in their first byte (a multiplexer). A Robstride
command has its torque in the identifier, which no DBC expresses; of its feedback there is the healthy one.
No DBC expresses the registers of a moteus either, whose frames hold now these, now those.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from .damiao import Damiao
from .imu import Imu, WorkbenchImu
from .mit import Mit
from .moteus import Moteus
from .odrive import TABLE, Odrive
from .robstride import Robstride
from .span import Span

Drive = Mit | Damiao | Robstride | Moteus | Odrive
_EXTENDED = 1 << 31  # marks a 29-bit identifier
_UNITS = {"position": "rad", "velocity": "rad/s", "torque": "N*m", "kp": "N*m/rad", "kd": "N*m*s/rad"}
_MOTION = (("position", 8, 16), ("velocity", 24, 12), ("torque", 36, 12))


def dbc(drives: Mapping[str, Drive], imu: Imu | None = None) -> str:
    """Return the text of a DBC file.

    Args:
        drives: axis -> drive; the axis becomes part of the names of messages and signals.
        imu: the inertial unit, as far as its frames are ours.
    """
    messages: list[str] = []
    types: list[str] = []
    answers: dict[int, list[str]] = {}
    for axis, drive in drives.items():
        if isinstance(drive, Moteus):
            continue
        if isinstance(drive, Odrive):
            own, more = _of_odrive(axis, drive.id)
            messages.append(own)
            types.append(more)
            continue
        if isinstance(drive, Robstride):
            id = 2 << 24 | 2 << 22 | drive.id << 8 | drive.reply_id
            signals = [
                _signal(n, 16 * k, 16, getattr(drive.fields, n)) for k, (n, _, _) in enumerate(_MOTION)
            ]
            signals.append(_line("temperature", 48, 16, 0.1, 0.0, "degC"))
            messages.append(_message(_EXTENDED | id, f"feedback_{axis}", signals))
            continue
        fields, offset, signals = drive.fields, 0, []
        for name, span in zip(fields._fields, fields, strict=True):
            signals.append(_signal(name, offset, span.bits, span))
            offset += span.bits
        messages.append(_message(drive.id, f"command_{axis}", signals))
        lines = answers.setdefault(drive.reply_id, _heads(drive))
        key = f"m{drive.id}"
        for name, at, bits in _MOTION:
            lines.append(_signal(f"{name}_{axis}", at, bits, getattr(fields, name), key))
        lines += _tail(axis, drive, key)
    for id, signals in answers.items():
        messages.append(_message(id, f"feedback_{id:x}", signals))
    if isinstance(imu, WorkbenchImu):
        for id, (quantity, span) in zip(imu.ids, imu.spans, strict=True):
            unit = "rad/s" if quantity == "angular" else ""
            signals = [
                _line(f"{quantity}_{axis}", 16 * k, 16, span.step, span.low, unit)
                for k, axis in enumerate("xyz")
            ]
            messages.append(_message(id, f"imu_{quantity}", signals, 6))
    return "\n".join(['VERSION ""', "", "NS_ :", "", "BS_:", "", "BU_: host drive", "", *messages, *types])


def _of_odrive(axis: str, id: int) -> tuple[str, str]:
    """Messages of a node by the drives' table, and the lines that say which of their signals are floats."""

    def placed(found: re.Match[str]) -> str:
        return f"BO_ {id << 5 | int(found[1])} {found[2]}_{axis}:"

    text = re.sub(r"^BO_ (\d+) (\w+):", placed, TABLE.read_text(encoding="ascii"), flags=re.MULTILINE)
    types = re.findall(r"^SIG_VALTYPE_ (\d+) (.*)$", text, re.MULTILINE)
    begin, end = text.index("BO_ "), text.index("SIG_VALTYPE_")
    return text[begin:end], "\n".join(f"SIG_VALTYPE_ {id << 5 | int(at)} {rest}" for at, rest in types)


def _heads(drive: Mit) -> list[str]:
    if isinstance(drive, Damiao):
        return [_line("id", 4, 4, 1.0, 0.0, "", "M"), _line("status", 0, 4, 1.0, 0.0, "")]
    return [_line("id", 0, 8, 1.0, 0.0, "", "M")]


def _tail(axis: str, drive: Mit, key: str) -> list[str]:
    """What stands behind an answer's motion."""
    if isinstance(drive, Damiao):
        names = (f"temperature_mosfet_{axis}", f"temperature_rotor_{axis}")
        return [_line(name, 48 + 8 * k, 8, 1.0, 0.0, "degC", key) for k, name in enumerate(names)]
    low = drive.temperature_offset
    lines = [_line(f"temperature_{axis}", 48, 8, 1.0, low, "degC", key)]
    lines.append(_line(f"fault_{axis}", 56, 8, 1.0, 0.0, "", key))
    return lines[: drive.length - 6]


def _message(id: int, name: str, signals: list[str], length: int = 8) -> str:
    return "\n".join([f"BO_ {id} {name}: {length} Vector__XXX", *signals, ""])


def _signal(name: str, offset: int, bits: int, span: Span, multiplexed: str = "") -> str:
    return _line(name, offset, bits, span.step, span.low, _UNITS[name.split("_")[0]], multiplexed)


def _line(
    name: str, offset: int, bits: int, scale: float, low: float, unit: str, multiplexed: str = ""
) -> str:
    """One big-endian signal `offset` bits into the message; DBC counts from each byte's lowest bit."""
    start = offset // 8 * 8 + 7 - offset % 8
    high = low + scale * ((1 << bits) - 1)
    mark = f" {multiplexed}" if multiplexed else ""
    return f' SG_ {name}{mark} : {start}|{bits}@0+ ({scale!r},{low!r}) [{low!r}|{high!r}] "{unit}" host'
