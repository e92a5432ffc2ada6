"""A joint of a mechanism that follows another, as through a belt or gears, or is held at a position."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from .errors import InputError
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
        InputError: the file is no XML, or a ``<mimic>`` has no joint or a number that is none.
    """
    try:
        raw = file.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=file, remedy="check the path") from error
    return couplings_in(parse_xml(raw, file, prefixes=False), file)


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
