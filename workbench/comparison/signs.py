"""Which columns have the wrong sign, from weight and inertia compared with the torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.models import Model

from .weighed import is_weighable, log_of, torque_left

MOTION = ("position", "velocity", "position_reference", "velocity_reference", "link_position")
TORQUE = ("torque_command", "torque_measured", "torque_feedforward", "current", "voltage")
_SOME = 2  # recordings are enough
_BAD = 0.1  # share of a torque left from which it is asked; weight alone is half right for a turned joint
_LEFT = 0.2  # of what was left, which no effect but a sign takes off by itself
_WORSE = 1.25  # times what was left, by which a turn may spoil an axis that it does not mend
_ALIKE = 1.5  # times more or less left of each axis, in which two explanations are one as good as the other


@dataclass(frozen=True)
class Turn:
    """One axis, and whether its motion, its torque or both have the opposite sign."""

    axis: str
    motion: bool
    torque: bool

    @property
    def columns(self) -> str:
        """Return the columns whose sign has to be changed."""
        if self.motion and self.torque:
            return f"all columns of '{self.axis}'"
        return f"{'position and velocity' if self.motion else 'torque'} of '{self.axis}'"

    def of(self, recording: Recording) -> Recording:
        """Return the recording with these signs changed."""
        sides = np.where([axis == self.axis for axis in recording.axes], -1.0, 1.0)
        named = MOTION * self.motion + TORQUE * self.torque
        signals = {
            name: x * sides if name in named and x.shape[1] == len(sides) else x
            for name, x in recording.signals.items()
        }
        return replace(recording, signals=signals)


@dataclass(frozen=True)
class Turned:
    """Sign changes that explain the torque equally well; largest residual share before and after."""

    turns: tuple[Turn, ...]
    before: float
    after: float

    def __str__(self) -> str:
        names = [turn.columns for turn in self.turns]
        which = " or ".join(dict.fromkeys(names))
        both = "; the data cannot tell which" if len(names) > 1 else ""
        now = f"{100 * self.before:.2g} %" if self.before < 1.0 else "all"
        return (
            f"negated ({which}{both}), the model leaves {100 * self.after:.2g} % of the torque "
            f"unexplained; as recorded, {now}"
        )


def turned_axes(model: Model, recordings: Sequence[Recording]) -> Turned | None:
    """Return the axes whose sign is opposite to that of the model, from the torque along the measured
    motion.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes.

    Returns:
        Every turn of one axis that explains the torque as well as the best; None where none is needed, or
        where no torque was logged.
    """
    some = recordings[:_SOME]
    if not is_weighable(model, some):
        return None
    try:
        before = torque_left(model, some)
        if before.max(initial=0.0) < _BAD:
            return None
        axes, sides = some[0].axes, ((True, True), (True, False), (False, True))
        turns = [Turn(axis, *side) for axis in axes[: model.size] for side in sides]
        left = {turn: torque_left(model, [turn.of(r) for r in some], some) for turn in turns}
    except SimulationError:
        return None
    good = {turn: log_of(x) for turn, x in left.items() if _explains(x, before)}
    if not good:
        return None
    best = min(good.values()) + model.size * np.log(_ALIKE)
    alike = tuple(turn for turn in turns if good.get(turn, np.inf) <= best)
    changed = left[alike[0]] < _LEFT * before
    return Turned(alike, float(before[changed].max()), float(left[alike[0]][changed].max()))


def _explains(left: np.ndarray, before: np.ndarray) -> bool:
    """Whether some axes' torque is explained that was not, and no other axis's worse than before.

    Where a turn leaves an axis that nothing explains, as play does, it is no turn that is missing.
    """
    if left.max() > 1.0:
        return False
    mended = (left < _LEFT * before) & (before > _BAD)
    return bool(mended.any() and (left <= np.maximum(_WORSE * before, _BAD)).all())
