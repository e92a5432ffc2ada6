"""Which axes count from another zero than the model, by quarters of a turn, as the weight of links tells.

Servos count from the middle of their turn, and arms are drawn upright or hanging. That is no small error of
an encoder, and springs and wrong links would be named in its place.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.models import Model

from .weighed import is_weighable, torque_left

_SOME = 2  # recordings are enough
_BAD = 0.1  # share of a torque left from which it is asked
_LEFT = 0.2  # of what was left, which no effect but another zero takes off by itself
_FEW = 3  # axes that are tried in every combination; of more, one at a time and all alike
_MOST = 8  # axes
_MOVED = ("position", "position_reference", "link_position")


@dataclass(frozen=True)
class Shifted:
    """What to add to each axis's positions [rad], nil of most; the largest share left before and after."""

    by: dict[str, float]
    before: float
    after: float

    def __str__(self) -> str:
        each = ", ".join(f"'{axis}' by {np.degrees(by):.0f} deg" for axis, by in self.by.items())
        now = f"{100 * self.before:.2g} %" if self.before < 1.0 else "all"
        left = f"the model leaves {100 * self.after:.2g} % of the torque unexplained"
        return f"moved ({each}), {left}, as it stands {now}"


def shifted_axes(model: Model, recordings: Sequence[Recording]) -> Shifted | None:
    """Quarters of a turn by which positions have to be moved for weight and inertia to agree with the torque.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes.

    Returns:
        The move that explains the torque; None where none is needed, or where no torque was logged.
    """
    some = recordings[:_SOME]
    if not is_weighable(model, some) or model.size > _MOST:
        return None
    turning = [i for i, unit in enumerate(some[0].units[: model.size]) if unit == "rad"]
    try:
        before = torque_left(model, some)
        if before.max(initial=0.0) < _BAD:
            return None
        left = {
            move: torque_left(model, [_moved(r, move) for r in some]) for move in _moves(model.size, turning)
        }
    except SimulationError:
        return None
    good = {
        move: float(np.log(np.maximum(x, 1e-12)).sum()) for move, x in left.items() if _explains(x, before)
    }
    if not good:
        return None
    best = min(good, key=lambda move: good[move])
    angles = np.where(np.array(best) == 3, -1, best) * np.pi / 2
    by = {axis: float(a) for axis, a in zip(some[0].axes, angles, strict=False) if a}
    return Shifted(by, float(before.max()), float(left[best].max()))


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


def _explains(left: np.ndarray, before: np.ndarray) -> bool:
    return bool(left.max() < _LEFT * before.max() and (left <= np.maximum(before, _BAD)).all())
