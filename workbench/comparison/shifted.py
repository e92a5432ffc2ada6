"""Which axes count from another zero than the model, by quarters of a turn, as the weight of links tells.

Servos count from the middle of their turn, and arms are drawn upright or hanging. That is no small error of
an encoder, and springs and wrong links would be named in its place.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from workbench.core import Recording
from workbench.models import Model

from .weighed import best_change, left_before_and_after

_FEW = 3  # axes that are tried in every combination; of more, one at a time and all alike
_MOVED = ("position", "position_reference", "link_position")


@dataclass(frozen=True)
class Shifted:
    """Shift of each axis's positions [rad], zero for most; largest residual share before and after the
    shift.
    """

    by: dict[str, float]
    before: float
    after: float

    def __str__(self) -> str:
        each = ", ".join(f"'{axis}' by {np.degrees(by):.0f} deg" for axis, by in self.by.items())
        return f"moved ({each}), {left_before_and_after(self.before, self.after, 'as it stands')}"


def shifted_axes(model: Model, recordings: Sequence[Recording]) -> Shifted | None:
    """Return the quarter turns by which positions have to be shifted so that weight and inertia agree with
    the torque.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes.

    Returns:
        The move that explains the torque; None where none is needed, or where no torque was logged.
    """
    units = recordings[0].units if recordings else ()
    turning = [i for i, unit in enumerate(units[: model.size]) if unit == "rad"]

    def moves(wrong: Sequence[int]) -> Iterator[tuple[int, ...]]:
        return _moves(model.size, turning)

    found = best_change(model, recordings, moves, _moved, lambda move: slice(None), in_place=True)
    if found is None:
        return None
    angles = np.where(np.array(found.change) == 3, -1, found.change) * np.pi / 2
    by = {axis: float(a) for axis, a in zip(recordings[0].axes, angles, strict=False) if a}
    return Shifted(by, float(found.before.max()), float(found.after.max()))


def _moves(size: int, turning: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Quarters of a turn of each axis."""
    if len(turning) <= _FEW:
        choices = [range(4) if i in turning else (0,) for i in range(size)]
        yield from (move for move in product(*choices) if any(move))
        return
    for quarters in (1, 2, 3):
        yield tuple(quarters if i in turning else 0 for i in range(size))
        for only in turning:
            yield tuple(quarters if i == only else 0 for i in range(size))


def _moved(recording: Recording, move: Sequence[int]) -> Recording:
    angle = np.array(move) * np.pi / 2
    signals = {
        name: x + angle if name in _MOVED and x.shape[1:] == angle.shape else x
        for name, x in recording.signals.items()
    }
    return replace(recording, signals=signals)
