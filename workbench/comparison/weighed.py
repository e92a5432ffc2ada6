"""The part of a torque that weight and inertia of a model do not explain, whatever its friction.

And which change of the columns of a log they explain in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
import scipy

from workbench.core import Recording, SimulationError
from workbench.effects import Plant, compile_plant
from workbench.models import Model
from workbench.recordings import NoiseLevels, noise_levels
from workbench.simulation import mass_matrix, scored_torque, smooth_track

from .inverse import lowpass, torque_pair
from .standing import on_ground

_MOST = 4000  # rows of a recording that are looked at
_FEWEST = 200  # rows that count, below which a motion is no evidence
_SOME = 2  # recordings are enough to choose a change
_BAD = 0.1  # share of a torque left from which a change is looked for
_LEFT = 0.2  # of what was left, which no effect but a change of columns takes off by itself
_MOST_AXES = 8  # of which changes are tried

Change = TypeVar("Change")


@dataclass(frozen=True)
class Changed(Generic[Change]):
    """A change of columns, and the unexplained share of each drive's torque before and after it, (n,)."""

    change: Change
    before: np.ndarray
    after: np.ndarray


def best_change(
    model: Model,
    recordings: Sequence[Recording],
    changes: Callable[[Sequence[int]], Iterable[Change]],
    made: Callable[[Recording, Change], Recording],
    axes: Callable[[Change], Sequence[int] | slice],
    *,
    in_place: bool = False,
) -> Changed[Change] | None:
    """Return the change of columns after which the model explains the torque; None if none is needed or none
    explains it.

    Args:
        model: what is believed; it may lack friction, or an effect that is no more than a part of the torque.
        recordings: of its axes; None where no torque was logged.
        changes: those to try, by the axes whose torque is not explained.
        made: a recording after a change.
        axes: those of which the torque has to be explained by it.
        in_place: whether each axis keeps its own sensors, and so their noise.
    """
    some = recordings[:_SOME]
    if not is_weighable(model, some) or model.size > _MOST_AXES:
        return None
    try:
        before = torque_left(model, some)
        wrong = np.flatnonzero(before > _BAD).tolist()
        like = some if in_place else None
        those = changes(wrong) if wrong else ()
        tried = [(c, torque_left(model, [made(r, c) for r in some], like)) for c in those]
    except SimulationError:
        return None
    good = [
        Changed(change, before, left)
        for change, left in tried
        if left[axes(change)].max() < _LEFT * before[axes(change)].max()
        and (left <= np.maximum(before, _BAD)).all()
    ]
    return min(good, key=lambda c: log_of(c.after), default=None)


def log_of(left: np.ndarray) -> float:
    """Return the logarithm of the product of shares (n,), by which changes are compared: axes count alike."""
    return float(np.log(np.maximum(left, 1e-12)).sum())


def left_before_and_after(before: float, after: float, as_it_stands: str) -> str:
    """Return the unexplained share in words: ``"the model leaves 1 % ..., as it stands 90 %"``."""
    now = f"{100 * before:.2g} %" if before < 1.0 else "all"
    return f"the model leaves {100 * after:.2g} % of the torque unexplained, {as_it_stands} {now}"


def is_weighable(model: Model, recordings: Sequence[Recording]) -> bool:
    """Return whether torque was logged along motions that only the drives and the weight cause."""
    return (
        not (model.floats or model.posture_dependent)
        and bool(recordings)
        and all(
            scored_torque(r) is not None and not on_ground(r) and int(r.valid.sum()) >= _FEWEST
            for r in recordings
        )
    )


def torque_left(
    model: Model, recordings: Sequence[Recording], like: Sequence[Recording] | None = None
) -> np.ndarray:
    """Return the share (n,) of each drive's squared torque that the model does not need along the measured
    motion.

    Of a joint without a drive it is the torque that the model lacks there, as a share of what the joint's own
    inertia takes. Friction and an offset of the torque are fitted away: they are what models lack most often,
    and what a wrong sign or unit must not be taken for.

    Args:
        model: what is believed.
        recordings: with a torque.
        like: recordings with the same noise of positions and speeds, which was estimated already.

    Raises:
        SimulationError: a model that no body can be.
    """
    return _left(compile_plant(model), recordings, recordings if like is None else like)


def _left(plant: Plant, recordings: Sequence[Recording], like: Sequence[Recording]) -> np.ndarray:
    sums = np.zeros((2, plant.model.size))
    for r, alike in zip(recordings, like, strict=True):
        levels = noise_levels(alike)
        measured, needed, valid = torque_pair(plant, r, None, levels)
        whole = measured if measured.any(axis=0).all() else _of_own_inertia(plant, r, measured, levels)
        logged = r.get("velocity")
        speed = np.gradient(r.position, r.period, axis=0) if logged is None else logged
        speed = speed if r.coordinates == "actuator" else speed @ plant.model.transmission.T
        rows = np.flatnonzero(valid)
        rows = rows[:: max(1, len(rows) // _MOST)]
        parts = ((measured - needed)[rows].T, whole[rows].T, speed[rows].T)
        for i, (rest, given, v) in enumerate(zip(*parts, strict=True)):
            one = np.ones_like(v)
            # friction brakes: of the right sign only, else it would stand in for a wrong one
            columns = np.column_stack([one, -one, v, np.sign(v)])
            sums[:, i] += scipy.optimize.nnls(columns, rest)[1] ** 2, float(given @ given)
    return np.divide(sums[0], sums[1], out=np.zeros(len(sums[0])), where=sums[1] > 0)


def _of_own_inertia(
    plant: Plant, recording: Recording, measured: np.ndarray, levels: NoiseLevels
) -> np.ndarray:
    """Return the measured torque (N, n), and of joints without a drive what their own inertia takes."""
    to_actuator = recording.to_actuator(plant.model.transmission)
    track = smooth_track(recording, None, to_actuator, levels.position_std, levels.velocity_std)
    own = np.diagonal(mass_matrix(plant, track), axis1=1, axis2=2) * track.acceleration
    return np.where(measured.any(axis=0), measured, lowpass(own, recording))
