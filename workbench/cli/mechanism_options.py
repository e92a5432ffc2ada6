"""What the command line says about a mechanism, as text, and what the words mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.core import InputError

if TYPE_CHECKING:
    from workbench.core import Controller


@dataclass(frozen=True)
class MechanismOptions:
    """What the command line says about a mechanism; text as it was given."""

    file: Path
    drives: Sequence[str]
    joints: Sequence[str]
    loops: Sequence[str]
    foot: str | None
    limits: Sequence[str]
    start: Sequence[str]
    hold: Sequence[str]
    gear: list[float] | None
    rotor_inertia: list[float] | None
    rotor_damping: list[float] | None
    torque_limit: list[float] | None
    delay: float
    kp: list[float] | None = None
    kd: list[float] | None = None
    period: float | None = None
    coordinates: str = ""
    hold_rest: bool = False


def loop_of(asked: MechanismOptions, count: int) -> Controller:
    """Return the PD loop of the drives, as far as the command line says.

    Raises:
        InputError: one gain without the other, or a value that no loop has.
    """
    from workbench.core import Controller

    if asked.kp is None and asked.kd is None:
        return Controller()
    if asked.kp is None or asked.kd is None:
        raise InputError("a loop has two gains", remedy="give --kp and --kd, one for all joints or one each")
    where = asked.coordinates or "joint"
    if where not in ("joint", "actuator"):
        raise InputError(f"--coordinates '{where}'", remedy="give joint or actuator")
    if asked.period is not None and not 0.0 < asked.period <= 1.0:
        raise InputError(f"--period {asked.period:g} s", remedy="give seconds, e.g. --period 0.002")
    kp, kd = one_each(asked.kp, count, 0.0, "--kp"), one_each(asked.kd, count, 0.0, "--kd")
    return Controller("pd", where, kp=kp, kd=kd, period_s=asked.period)


def frames_of(text: str) -> tuple[str, str]:
    """Return the two frames of ``A:B``.

    Raises:
        InputError: it is not of this form.
    """
    first, colon, second = text.partition(":")
    if not (first and colon and second):
        raise InputError(f"--loop '{text}' is not A:B", remedy="name two frames of the file")
    return first, second


def range_of(text: str) -> tuple[float, float]:
    """Return the numbers of ``LOW:HIGH`` [rad or m].

    Raises:
        InputError: it is not of this form, or the first is not the lower one.
    """
    low, high = map(number_of, text.partition(":")[::2])
    if not low < high:
        raise InputError(f"limits '{text}' are not LOW:HIGH", remedy="e.g. --limits knee=0.35:2.6")
    return low, high


def number_of(text: str) -> float:
    """Return a finite number.

    Raises:
        InputError: it is none.
    """
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise InputError(f"'{text}' is not a number", remedy="give a finite number")
    return value


def one_each(values: list[float] | None, count: int, default: float, option: str) -> tuple[float, ...]:
    """Return a value per drive from what an option says: one for all, one each, or the default.

    Raises:
        InputError: another number of values, or one below zero.
    """
    given = values or [default]
    if len(given) not in (1, count):
        raise InputError(
            f"{len(given)} values of {option} for {count} drives", remedy="give one, or one each"
        )
    if any(not v >= 0.0 for v in given):
        raise InputError(f"{option} is negative", remedy="give numbers of zero or more")
    return tuple(given * count if len(given) == 1 else given)
