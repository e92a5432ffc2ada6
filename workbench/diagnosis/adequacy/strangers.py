"""Removal of what no effect explains: a tone, or a smooth function of time or a position.

What is certain beside an unknown torque has its size there too, but for what the two have in common. With the
unknown torque taken out, as far as a free function knows it, the other's estimate is no longer drawn to it
(backfitting of partially linear models: A. Buja, T. Hastie and R. Tibshirani, Annals of Statistics 17(2),
1989).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from workbench.core import EffectKey, Recording, Shape
from workbench.effects import effect_named, kinds
from workbench.simulation import scored_torque

from ..data import Data
from ..evidence.missing_torque import Missing
from ..evidence.shape import shapes
from ..hypothesis import Fit
from ..policy import POLICY

_STEP_S = 0.01  # between the rows that functions are fitted to
_POSITION = "position"


def without_strangers(found: Fit, data: Data, certain: Collection[EffectKey]) -> tuple[Recording, ...] | None:
    """Return recordings whose torque lacks what a free function explains of the residual on each axis.

    Args:
        found: all effects that were selected, along the measured motion.
        data: of that motion.
        certain: effects whose own law no function may stand in for.

    Returns:
        None where no function explains enough on any axis.
    """
    missing, rows = rest_of(found, data)
    unknown: dict[int, Shape] = {}
    for k, axis in enumerate(missing.axes):
        own = [kinds.depends_on(effect_named(key.effect)) for key in certain if key.axis == axis]
        taken = {_POSITION} if any(_POSITION in d for d in own) else set()
        for shape in shapes(missing, axis, of_two=False):
            free = shape.frequency is not None or _is_free(shape, taken)
            if shape.share >= POLICY.unknown_most and free:
                unknown[k] = shape
                break
    if not unknown:
        return None
    out = []
    for i, recording in enumerate(data.recordings):
        name = scored_torque(recording)
        if name is None:
            return None
        torque = recording.signals[name].copy()
        for k, shape in unknown.items():
            torque[:, k] -= _torque(shape, recording, missing.torque[rows[i], k], missing.time[rows[i]])
        out.append(recording.with_signals(**{name: torque}))
    return tuple(out)


def _is_free(shape: Shape, taken: Collection[str]) -> bool:
    """Return whether a shape depends on a quantity that belongs neither to friction nor to a certain law."""
    return shape.quantities[0] not in {"speed", "load", *taken}


def rest_of(found: Fit, data: Data) -> tuple[Missing, list[slice]]:
    """Return the torque residual that the effects leave, thinned, and the rows of each recording."""
    first = data.recordings[0]
    stride = max(1, round(_STEP_S / first.period))
    torque, position, speed, time, rows, count = [], [], [], [], [], 0
    for i, recording in enumerate(data.recordings):
        rest = data.residual(i, found.simulated[i])[::stride, 1]
        torque.append(rest - rest.mean(axis=0))
        position.append(recording.position[::stride])
        speed.append(np.gradient(position[-1], stride * recording.period, axis=0))
        time.append(recording.time[::stride])
        rows.append(slice(count, count + len(rest)))
        count += len(rest)
    still = np.zeros((count, len(first.axes)))
    missing = Missing(
        torque=np.concatenate(torque),
        position=np.concatenate(position),
        speed=np.concatenate(speed),
        acceleration=still,
        load=still,
        time=np.concatenate(time),
        temperature=None,
        start=tuple(r.start for r in rows),
        step=stride * first.period,
        axes=first.axes,
        units=first.units,
    )
    return missing, rows


def _torque(shape: Shape, recording: Recording, rest: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Return the torque that a shape adds at each row of a recording (N,), from its values at some times."""
    if shape.frequency is not None:
        turn = 2.0 * np.pi * shape.frequency
        at = [np.stack([np.cos(turn * t), np.sin(turn * t)], axis=1) for t in (time, recording.time)]
        return at[1] @ np.linalg.lstsq(at[0], rest, rcond=None)[0]
    return np.interp(_values(shape.quantities[0], shape.axis, recording), shape.grid, shape.torque)


def _values(quantity: str, axis: str, recording: Recording) -> np.ndarray:
    if quantity == "time":
        return recording.time
    axes: Sequence[str] = recording.axes
    name = axis if quantity == _POSITION else quantity.removeprefix("the position of ")
    return recording.position[:, axes.index(name)]
