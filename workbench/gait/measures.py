"""What two recordings show of a gait, in numbers."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.shown import Shown

from .bootstrap import Interval


@dataclass(frozen=True)
class Measure:
    """One line.

    Attributes:
        name, unit: of what, and the unit of gap and floor.
        gap: how far the two are apart.
        floor: how far the hardware's second run is from its first; None without one.
        hardware, simulator: what each shows; None where only the gap has a meaning.
        seen_in: unit of these two.
    """

    name: str
    unit: str
    gap: Interval
    floor: Interval | None = None
    hardware: Interval | None = None
    simulator: Interval | None = None
    seen_in: str = ""


@dataclass(frozen=True, repr=False)
class Gait(Shown):
    """What two recordings show of a gait.

    Attributes:
        hardware, simulator, again: names of the recordings; `again` is None where there was none.
        command: speeds that E_phi is a share of, forward [m/s] and turning [rad/s].
        measures: those that could be made.
        lacking: a line for each that could not, with the reason.
    """

    hardware: str
    simulator: str
    again: str | None
    command: tuple[float, float]
    measures: tuple[Measure, ...]
    lacking: tuple[str, ...]
