"""Axes whose logged torque pushes against what weight and inertia need, told axis by axis.

A turn of one axis is looked for elsewhere, where it leaves a model that explains all axes. Here nothing is
asked of the axes that neither sign explains, as where friction of wrists hides their weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.models import Model
from workbench.simulation import scored_torque

from .weighed import is_weighable, left_before_and_after, torque_left

_SOME = 2  # recordings are enough
_LEFT = 0.2  # of what the other sign leaves, by which one is plain
_HALF = 0.5  # share of a torque left, below which a sign explains it, and above which the other does not


@dataclass(frozen=True)
class Reversed:
    """Axes whose torque is plainly reversed; largest residual share of these before and after it is negated.

    Attributes:
        axes: in the model's order.
        signal: the torque that is meant.
        whole: whether no axis is plainly right, so that the torque as a whole is reversed.
        before, after: as it stands, and negated.
    """

    axes: tuple[str, ...]
    signal: str
    whole: bool
    before: float
    after: float

    def __str__(self) -> str:
        named = " and ".join(f"'{axis}'" for axis in self.axes)
        which = f"all axes (evident from weight and inertia at {named})" if self.whole else named
        left = left_before_and_after(self.before, self.after, "as recorded")
        return f"{self.signal} of {which} has the opposite sign to that of the model: negated, {left}"


def reversed_torques(model: Model, recordings: Sequence[Recording]) -> Reversed | None:
    """Return the axes whose torque weight and inertia of the model explain only with the opposite sign.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes; ask after `shifted_axes`, since a turned arm has its weights reversed too.

    Returns:
        None where no axis is plainly so, where no torque was logged, or where belts mix the drives' torques
        and not all are reversed.
    """
    some = recordings[:_SOME]
    if not is_weighable(model, some):
        return None
    signals = {scored_torque(r) for r in some}
    name = signals.pop()
    if signals or name is None:
        return None
    try:
        before = torque_left(model, some)
        after = torque_left(model, [r.with_signals(**{name: -r.signals[name]}) for r in some], some)
    except SimulationError:
        return None
    plain = _is_plain(after, before)
    coupled = np.count_nonzero(model.transmission) > model.size
    if not plain.any() or (coupled and not plain.all()):
        return None
    axes = tuple(axis for axis, so in zip(some[0].axes, plain, strict=False) if so)
    whole = len(axes) > 1 and not _is_plain(before, after).any()
    return Reversed(axes, name, whole, float(before[plain].max()), float(after[plain].max()))


def _is_plain(left: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Whether one sign explains each axis (n,) and the other one does not."""
    return (left < _LEFT * other) & (left < _HALF) & (other > _HALF)
