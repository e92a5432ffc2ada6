"""Joints of a mechanism that follow others, as through a belt or gears, or are held at a position."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .errors import InputError
from .files import read_file
from .xml import parse_xml


@dataclass(frozen=True)
class Coupling:
    """``position(joint) = sum of polynomial[k] * position(follows)^k`` [rad or m].

    Attributes:
        joint: the joint that follows.
        follows: the joint that it follows; None where it is held still.
        polynomial: from the constant on; of a joint that is held its position alone.
    """

    joint: str
    follows: str | None
    polynomial: tuple[float, ...]

    def at(self, position: float) -> tuple[float, float, float]:
        """The joint's position and its first and second derivative, with the other joint at `position`."""
        value = slope = bend = 0.0
        for factor in reversed(self.polynomial):
            bend = 2.0 * slope + position * bend
            slope = value + position * slope
            value = factor + position * value
        return value, slope, bend


def declared_couplings(file: Path) -> tuple[Coupling, ...]:
    """Return joints that follow others according to the file: ``<mimic>`` of a URDF or SDF.

    Raises:
        InputError: the file cannot be read or is no XML, or a ``<mimic>`` has no joint or no valid number.
    """
    return couplings_in(parse_xml(read_file(file), file, prefixes=False), file)


def couplings_in(root: ElementTree.Element, file: Path) -> tuple[Coupling, ...]:
    """Return the same from the file's XML."""
    return tuple(
        _mimic(joint.get("name", ""), mimic, file)
        for joint in root.iter("joint")
        for mimic in joint.iter("mimic")
    )


def _mimic(name: str, mimic: ElementTree.Element, file: Path) -> Coupling:
    def number(key: str, default: float) -> float:
        child = mimic.find(key)  # SDF has elements where URDF has attributes
        text = mimic.get(key) if child is None else child.text
        return default if text is None else float(text)

    try:
        leader = mimic.attrib["joint"]
        factor, offset, reference = number("multiplier", 1.0), number("offset", 0.0), number("reference", 0.0)
    except (KeyError, ValueError) as error:
        raise InputError(
            f"joint '{name}' has a <mimic> without a joint, or with a value that is not a number",
            file=file, column="mimic", remedy="give joint, multiplier and offset",
        ) from error  # fmt: skip
    return Coupling(name, leader, (offset - factor * reference, factor))


@dataclass(frozen=True)
class BoundJoints:
    """Couplings as equations in the coordinates of a tree, zero when they are met.

    Attributes:
        pairs: each coupling, the coordinate that follows, and the one followed (None: it is held).
    """

    pairs: tuple[tuple[Coupling, int, int | None], ...]

    @staticmethod
    def of(couplings: Sequence[Coupling], place: Callable[[str], int]) -> BoundJoints:
        """Return the couplings of a tree; `place` gives the coordinate of a joint."""
        return BoundJoints(
            tuple((c, place(c.joint), place(c.follows) if c.follows else None) for c in couplings)
        )

    def gap(self, theta: np.ndarray) -> np.ndarray:
        """Return the distance of each joint from its required position (k,) [rad or m]."""
        return np.array([theta[a] - c.at(0.0 if b is None else theta[b])[0] for c, a, b in self.pairs])

    def jacobian(self, theta: np.ndarray) -> np.ndarray:
        """Return d gap / d theta (k, N)."""
        rows = np.zeros((len(self.pairs), len(theta)))
        for row, (c, a, b) in zip(rows, self.pairs, strict=True):
            row[a] = 1.0
            if b is not None:
                row[b] -= c.at(theta[b])[1]
        return rows

    def bias(self, theta: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return the second derivative of the gap at zero acceleration (k,)."""
        bends = (0.0 if b is None else -c.at(theta[b])[2] * rates[b] ** 2 for c, _, b in self.pairs)
        return np.fromiter(bends, float, len(self.pairs))
