"""Units as people write them in headers, and what the size of numbers says without a unit."""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache

import numpy as np

from workbench.core.units import KINDS, to_si

from .counts import turn_of

#: Speed of positions that are counts; how many make a turn is asked.
COUNTS_A_SECOND = "counts/s"
#: Factors by which a decimal point slips.
TENS = (0.1, 10.0, 0.01, 100.0, 0.001, 1000.0)
_TENTH = 0.003  # how often one does, against a unit that is right
_GIGA = 1e8
_USUAL = 1.5  # rad, through which a joint moves while it is logged
_VARIES = 1.1  # deviations of that by a factor of e
#: Spellings that pint reads otherwise or not at all ("Nm" is a nanometre to it).
_SPELLINGS: dict[str, tuple[str, ...]] = {
    "N*m": ("nm", "n m", "n.m", "n·m", "n*m", "n-m", "newtonmeter", "newton meter"),
    "mN*m": ("mnm", "mn m", "mn.m", "mn·m", "mn*m"),
    "N*mm": ("nmm", "n mm", "n.mm", "n·mm", "n*mm"),
    "cN*m": ("cnm", "cn m", "cn.m", "cn·m", "cn*m"),
    "N*cm": ("ncm", "n cm", "n.cm", "n·cm", "n*cm"),
    "kN*m": ("knm", "kn m", "kn·m", "kn*m"),
    "deg": ("deg", "degree", "degrees", "°", "grad", "degs"),
    "rad": ("rad", "radian", "radians", "rads"),
    "mrad": ("mrad",),
    "mdeg": ("mdeg",),
    "turn": ("rev", "revs", "turn", "turns", "rot", "revolutions", "u"),
    "deg/s": (
        "deg/s",
        "°/s",
        "dps",
        "degs/s",
        "degps",
        "deg/sec",
        "degree/s",
        "degrees/s",
        "deg s",
        "grad/s",
    ),
    "rad/s": ("rad/s", "rads/s", "radps", "rad/sec", "rad s", "rads", "1/s"),
    "rpm": ("rpm", "1/min", "u/min", "rev/min", "min-1", "min^-1"),
    "turn/s": ("rev/s", "turn/s", "turns/s", "rps"),
    "s": ("s", "sec", "secs", "second", "seconds"),
    "ms": ("ms", "msec", "millis", "milliseconds", "millisecond"),
    "us": ("us", "µs", "μs", "usec", "micros", "microseconds"),
    "ns": ("ns", "nsec", "nanos", "nanoseconds", "nanosec"),
    "m": ("m", "meter", "meters", "metre"),
    "mm": ("mm",),
    "cm": ("cm",),
    "m/s": ("m/s", "m/sec", "mps", "m s"),
    "mm/s": ("mm/s", "mm s"),
    "N": ("n", "newton"),
    "kN": ("kn",),
    "A": ("a", "amp", "amps", "ampere"),
    "mA": ("ma",),
    "V": ("v", "volt", "volts"),
    "mV": ("mv",),
    "degC": ("c", "°c", "degc", "celsius"),
    "K": ("k", "kelvin"),
}


@lru_cache(maxsize=1024)
def pint_unit(text: str, kind: str) -> str:
    """Return the unit as pint writes it; ``""`` if `text` is no unit of this kind."""
    number, star, plain = text.partition("*")
    if star and _is_factor(number, kind):
        unit = pint_unit(plain.strip(), kind)
        return f"{float(number):g}*{unit}" if unit else ""
    if unit := _spelling(text, kind):
        return unit
    # a unit that pint knows as it stands: "mrad/s", "N*mm"; its "Grad/s" is 1e9 rad/s, which nobody logs
    return text if len(text) > 1 and _is_of(text, kind) and scale(text, kind) < _GIGA else ""


def has_factor(unit: str) -> bool:
    """Return whether a unit, as `pint_unit` writes it, is a number of units."""
    return unit.lstrip("-")[:1].isdigit()


def times(factor: float, unit: str) -> str:
    """Return a unit with a factor, multiplied by another number."""
    number, _, plain = unit.partition("*")
    return f"{factor * float(number):.9g}*{plain}"


def _is_factor(text: str, kind: str) -> bool:
    """Whether a text is a number of units, negative where columns count the other way; no clock does."""
    try:
        number = float(text)
    except ValueError:
        return False
    return 0.0 < (number if kind == "time" else abs(number)) < float("inf")


def spelled(text: str, kind: str) -> bool:
    """Return whether `text` is a unit of this kind ending a name; foot and link are joints there."""
    return bool(_spelling(text, kind))


def _spelling(text: str, kind: str) -> str:
    plain = " ".join(text.strip().lower().replace("⋅", "·").split())
    named = (u for u, spellings in _SPELLINGS.items() if plain in spellings or plain == u.lower())
    return next((unit for unit in named if _is_of(unit, kind)), "")


def fits(text: str, kind: str) -> bool:
    """Return whether `text` is a unit of this kind."""
    return bool(pint_unit(text, kind))


def known_unit(text: str) -> bool:
    """Return whether `text` is a unit of any kind."""
    return any(pint_unit(text, kind) for kind in KINDS)


def _is_of(unit: str, kind: str) -> bool:
    if kind not in KINDS:
        return False  # the number of a row, "n", is of no kind that has units
    try:
        to_si(unit, kind)
    except ValueError:
        return False
    return True


def scale(unit: str, kind: str) -> float:
    """Return the SI value of the unit."""
    return to_si(unit, kind)[0]


def is_linear(unit: str, kind: str) -> bool:
    """Return whether the unit belongs to an axis that moves along a line."""
    return to_si(unit, kind)[2] in ("m", "m/s", "N")


def equations(words: Collection[str]) -> bool:
    """Return whether a name is that of a variable in equations, which use radians; drives use turns too."""
    return not {"q", "dq", "qd", "qdot", "dqdot", "qpos", "qvel", "theta", "omega", "phi"}.isdisjoint(words)


def by_size(
    kind: str, values: np.ndarray, linear: bool, *, symbols: bool = False, tied: bool = False
) -> dict[str, float]:
    """Return weights of the units that numbers of this size may have.

    Args:
        kind: ``position``, ``velocity`` or ``torque``.
        values: all columns of the kind, shape (N, n).
        linear: whether they are of axes that move along a line.
        symbols: whether their names are those of equations.
        tied: whether a velocity is known to be the derivative of a position of some unit.
    """
    top = float(np.nanmax(np.abs(values), initial=0.0))
    if linear:
        return {
            "position": {"m": _falls(top, 5.0, 3.0), "mm": _rises(top, 5.0, 3.0)},
            "velocity": {"m/s": _falls(top, 5.0, 2.0), "mm/s": _rises(top, 5.0, 2.0)},
            "torque": {"N": 1.0},
        }[kind]
    if kind == "position":
        whole = bool(np.all(values[np.isfinite(values)] == np.round(values[np.isfinite(values)])))
        spread = float(np.nanmax(np.ptp(np.nan_to_num(values), axis=0), initial=0.0))
        # a joint that turns more than once reads like degrees of one that hardly moves: then it is asked
        return {
            # equations are in radians, of wheels and of motors before their gears too
            "rad": _falls(max(top / 1.5, spread), 7.0, 1.2 if symbols else 3.0),
            "deg": _rises(top, 15.0, 3.0) * _falls(top, 3000.0, 3.0),
            # what has the same slope in both is told by its size alone, and hardly by that
            "turn": (0.06 if symbols else 0.1) * _usual(2.0 * np.pi * spread) / _usual(spread),
            "counts": 30.0 if (whole and top > 500) or turn_of(values) else 0.0,
        }
    if kind == "velocity":
        return {
            "rad/s": _falls(top, 40.0, 1.0 if symbols else 2.0),
            "deg/s": _rises(top, 40.0, 2.0) * _falls(top, 5000.0, 2.0),
            "rpm": 0.05 if top > 20 else 0.005,
            "turn/s": 0.5 if tied else 0.005,
            # who logs an encoder's steps logs them a second too; no other unit goes with these
            COUNTS_A_SECOND: 0.5 if tied else 0.0,
            **({f"{k:g}*{unit}": _TENTH for k in TENS for unit in ("rad/s", "deg/s")} if tied else {}),
        }
    return {
        "N*m": _falls(top, 600.0, 2.0),
        "mN*m": 0.3 * _rises(top, 600.0, 2.0) + 0.005,
        "N*mm": 0.7 * _rises(top, 600.0, 2.0) + 0.005,
        "cN*m": 0.2 * _rises(top, 600.0, 2.0) + 0.002,
    }


def by_step(step: float, start: float, rows: int) -> dict[str, float]:
    """Return weights of the units of a clock, from its typical increment and its first stamp.

    Robots are logged at 10 Hz to 10 kHz, and a stamp near now, counted since 1970, tells its unit by itself.
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if 1e9 < start * size < 3e9:
            return {unit: 1.0, **dict.fromkeys({"s", "ms", "us", "ns"} - {unit}, 1e-6)}
    out = {}
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        seconds = step * size
        usual = np.exp(-0.5 * (np.log(seconds / 3e-3) / 1.2) ** 2) if seconds > 0 else 0.0
        long = rows * seconds
        out[unit] = float(usual) * (1.0 if 0.5 < long < 7200 else 0.05) + 1e-9
    return out


def _usual(spread: float) -> float:
    """How usual it is that the joint that moves most moves through so many radians."""
    return float(max(np.exp(-0.5 * (np.log(max(spread, 1e-9) / _USUAL) / _VARIES) ** 2), 0.02))


def _falls(x: float, edge: float, power: float) -> float:
    x = min(x, 1e6 * edge)  # beyond, it is nothing, and its power may be no number
    return 1.0 / (1.0 + (x / edge) ** (2 * power))


def _rises(x: float, edge: float, power: float) -> float:
    return 1.0 - _falls(x, edge, power) + 0.01
