"""Which two axes have each other's columns, from weight and inertia; this cannot be seen without a model."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from workbench.core import Recording
from workbench.models import Model

from .weighed import best_change, left_before_and_after


@dataclass(frozen=True)
class Swapped:
    """Two axes with exchanged columns; largest residual share before and after the exchange."""

    axes: tuple[str, str]
    before: float
    after: float

    def __str__(self) -> str:
        return f"exchanged, {left_before_and_after(self.before, self.after, 'as they stand')}"


def swapped_axes(model: Model, recordings: Sequence[Recording]) -> Swapped | None:
    """Return two axes of which each has all columns of the other; None if there are none.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes.

    Returns:
        The pair that explains the torque; None where none is needed, or where no torque was logged.
    """

    def pairs(wrong: Sequence[int]) -> Iterable[tuple[int, ...]]:
        return combinations(wrong, 2)

    found = best_change(model, recordings, pairs, _exchanged, list)
    if found is None:
        return None
    pair, names = list(found.change), recordings[0].axes
    first, second = pair
    return Swapped(
        (names[first], names[second]), float(found.before[pair].max()), float(found.after[pair].max())
    )


def _exchanged(recording: Recording, pair: Sequence[int]) -> Recording:
    """The recording with all signals of two axes exchanged."""
    order = np.arange(len(recording.axes))
    order[list(pair)] = order[list(pair)[::-1]]
    signals = {
        name: x[:, order] if x.ndim == 2 and x.shape[1] == len(order) else x
        for name, x in recording.signals.items()
    }
    return replace(recording, signals=signals)
