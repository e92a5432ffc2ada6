"""An excitation made small enough for the machine: simulate, find the limit that binds, shrink, repeat."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import InputError, SimulationError

from .excitation import Design

#: Predicted signals of all experiments of a design, by quantity: (rows, columns), one column a limit.
Predict = Callable[[Design], Mapping[str, np.ndarray]]

_SMALLEST = 1e-3  # a design shrunk further than this measures nothing
_TRIES = 25
_MARGIN = 0.05  # share of the room that is kept free


@dataclass(frozen=True)
class Limit:
    """The range of a signal: `quantity` (position, speed, torque), `name` of axis or joint, low, high."""

    quantity: str
    name: str
    low: float
    high: float
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.quantity} of {self.name} ({self.low:.4g} to {self.high:.4g} {self.unit})".rstrip()


@dataclass(frozen=True, eq=False)
class Scaled:
    """A design that stays within limits, and by which factor it was shrunk.

    Attributes:
        design: the design, scaled.
        factor: by how much, 1 where it was small enough.
        binding: the limit that was the tightest; None where there are no limits.
        usage: share of the room from rest to the limit that each limit's signal uses, by limit.
    """

    design: Design
    factor: float
    binding: Limit | None
    usage: Mapping[Limit, float]


def scale_to_limits(design: Design, simulate: Predict, limits: Sequence[Limit]) -> Scaled:
    """Return a design shrunk until its predicted signals stay within limits; it is never made larger.

    The response need not be proportional (gravity, saturation): every new size is simulated.

    Args:
        design: what to play.
        simulate: predicts, for a design, every quantity that has limits: (rows, columns), the rows of all
            experiments one after another, the first at rest; columns in the order of that quantity's limits.
        limits: where the signals may go.

    Raises:
        InputError: a limit is broken at rest already, or stays broken however small the excitation is.
    """
    if not limits:
        return Scaled(design, 1.0, None, {})
    goal = 1.0 - _MARGIN
    factor, inside, outside = 1.0, None, (np.inf, np.inf)
    worst = limits[0]
    for _ in range(_TRIES):
        scaled = _try(design, factor, simulate, limits)
        worst = scaled.binding or worst
        most = scaled.usage[worst]
        if factor == 1.0 and most <= 1.0:
            return scaled
        if most <= goal:
            inside = scaled
            if most >= 0.9 * goal or outside[0] < 1.02 * factor:
                break
        else:
            outside = (factor, most)
        if inside is None:
            factor *= float(np.clip(goal / most, 0.1, 0.98))
        else:
            # a response that grows faster than its excitation was shrunk too far at first
            low, high = inside.factor, outside[0]
            below, above = inside.usage[worst], outside[1]
            power = np.log(high / low) / np.log(above / below) if above > below > 0 else 0.5
            share = power * np.log(0.97 * goal / max(below, 1e-9)) / np.log(high / low)
            factor = float(low * (high / low) ** np.clip(share, 0.1, 0.9))
        if factor < _SMALLEST:
            break
    if inside is not None:
        return inside
    raise InputError(
        f"the limit on {worst} is passed even when the excitation is {factor:.2g} of its size",
        column=worst.name, remedy="choose another posture or a wider limit",
    )  # fmt: skip


def _try(design: Design, factor: float, simulate: Predict, limits: Sequence[Limit]) -> Scaled:
    small = design if factor == 1.0 else design.scaled(factor)
    try:
        usage = _usage(simulate(small), limits)
    except SimulationError:
        usage = dict.fromkeys(limits, 2.0)  # too large for the model even to run
    return Scaled(small, factor, max(limits, key=lambda limit: usage[limit]), usage)


def _usage(predicted: Mapping[str, np.ndarray], limits: Sequence[Limit]) -> dict[Limit, float]:
    """Return for each limit the share used of the room between the first row and the limit."""
    usage = {}
    seen: dict[str, int] = {}
    for limit in limits:
        column = seen.get(limit.quantity, 0)
        seen[limit.quantity] = column + 1
        signal = np.asarray(predicted[limit.quantity])[:, column]
        rest = float(signal[0])
        if not limit.low < rest < limit.high:
            raise InputError(
                f"the {limit.quantity} is {rest:.4g} {limit.unit} at rest, not inside {limit}",
                column=limit.name,
                remedy="choose another posture; without --loop or a [controller] nothing holds one",
            )
        up, down = (signal.max() - rest) / (limit.high - rest), (rest - signal.min()) / (rest - limit.low)
        # a run that left the numbers is far outside, nobody knows how far
        usage[limit] = float(max(up, down)) if np.isfinite(signal).all() else 2.0
    return usage
