"""Which two axes have each other's columns, as weight and inertia tell: without a model nothing is odd."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.models import Model

from .weighed import is_weighable, torque_left

_SOME = 2  # recordings are enough
_BAD = 0.1  # share of a torque left from which it is asked
_LEFT = 0.2  # of what was left on both axes, which no effect but an exchange takes off by itself
_MOST = 8  # axes, of which any two are tried


@dataclass(frozen=True)
class Swapped:
    """Two axes with each other's columns; the largest share of their torque left before and after."""

    axes: tuple[str, str]
    before: float
    after: float

    def __str__(self) -> str:
        now = f"{100 * self.before:.2g} %" if self.before < 1.0 else "all"
        left = f"the model leaves {100 * self.after:.2g} % of the torque unexplained"
        return f"exchanged, {left}, as they stand {now}"


def swapped_axes(model: Model, recordings: Sequence[Recording]) -> Swapped | None:
    """Two axes of which each has the other's columns, all of them.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes.

    Returns:
        The pair that explains the torque; None where none is needed, or where no torque was logged.
    """
    some = recordings[:_SOME]
    if not is_weighable(model, some) or model.size > _MOST:
        return None
    try:
        before = torque_left(model, some)
        wrong = [i for i in range(model.size) if before[i] > _BAD]
        if not wrong:
            return None
        left = {
            pair: torque_left(model, [_exchanged(r, *pair) for r in some])
            for pair in combinations(range(model.size), 2)
            if set(pair) <= set(wrong)
        }
    except SimulationError:
        return None
    good = {
        pair: x
        for pair, x in left.items()
        if (x[list(pair)].max() < _LEFT * before[list(pair)].max()) and (x <= np.maximum(before, _BAD)).all()
    }
    if not good:
        return None
    first, second = min(good, key=lambda pair: float(np.log(good[pair]).sum()))
    pair = [first, second]
    axes = some[0].axes
    return Swapped(
        (axes[first], axes[second]), float(before[pair].max()), float(good[first, second][pair].max())
    )


def _exchanged(recording: Recording, first: int, second: int) -> Recording:
    """The recording with all signals of two axes exchanged."""
    order = np.arange(len(recording.axes))
    order[[first, second]] = order[[second, first]]
    signals = {
        name: x[:, order] if x.ndim == 2 and x.shape[1] == len(order) else x
        for name, x in recording.signals.items()
    }
    return replace(recording, signals=signals)
