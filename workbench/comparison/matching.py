"""Recordings prepared for a model: with its axes, and with assumptions for what their logs do not state of
the loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import MARGIN_TOTAL, InputError, Recording
from workbench.models import Model
from workbench.simulation import check_axes

from .by_mujoco import by_mujoco
from .closed_loop import ClosedLoop
from .evaluate import evaluate
from .floating import with_base
from .following import InverseDynamicsReplay
from .replay import Replay
from .replay_of import replay_of
from .score import pooled, score_runs, scored_signals, squares
from .standing import check_ground, on_ground
from .touching import refuse_overlaps
from .unlogged import LoopAssumption, noted, readings

_FEWEST = 30  # rows: from fewer neither their noise nor the start of a run can be told


def matched(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the recordings as they are compared with this model: with the axes of a floating base, and with
    the most likely assumptions about the loop.

    Raises:
        InputError: as `matched_ways`.
    """
    return matched_ways(model, recordings)[0]


def matched_ways(model: Model, recordings: Sequence[Recording]) -> tuple[tuple[Recording, ...], ...]:
    """Return the recordings for all assumptions about the loop that may be right, the most likely first.

    Raises:
        InputError: none given, other axes, a base that floats on one side only, very few rows, or links that
            overlap wherever they were.
    """
    if not recordings:
        raise InputError("no recordings given", remedy="name at least one recording's TOML file")
    out = tuple(with_base(r, model) for r in recordings)
    for r in out:
        check_axes(r, model)
        if len(r) < _FEWEST:
            raise InputError(
                f"{len(r)} rows are too few to distinguish motion from noise", file=r.source,
                remedy=f"record for longer, {_FEWEST} rows at least and seconds of motion",
            )  # fmt: skip
        if on_ground(r):
            check_ground(model, r)
    if model.posture_dependent or model.carried is not None:
        return (out,)
    refuse_overlaps(model, out)
    return _likely(model, readings(model, out))


@dataclass(frozen=True)
class MadeByMujoco:
    """Recordings taken as made by MuJoCo from the model's file, and what a run of the model says of that.

    `error`: of the run without noise; `usual`: of that on recordings of a machine; `change`: mean squares
    (2, n) of their difference, position and torque.
    """

    recordings: tuple[Recording, ...]
    error: float
    usual: float
    change: np.ndarray


def as_compared(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the recordings as `compare` takes them: as MuJoCo made them, if only then the model explains
    them.

    Raises:
        InputError: as `matched_ways`.
    """
    usual = matched(model, recordings)
    made = explained_by_mujoco(model, usual, recordings)
    return usual if made is None or _explains(model, usual) else made


def explained_by_mujoco(
    model: Model, usual: Sequence[Recording], given: Sequence[Recording]
) -> tuple[Recording, ...] | None:
    """Return recordings that a model explains if MuJoCo made them from its file; None if it does not.

    Args:
        model, usual, given: as of `made_by_mujoco`; the model does not explain the usual ones.
    """
    lower = [made for made in made_by_mujoco(model, usual, given) if made.error < made.usual]
    if not lower:
        return None
    best = min(lower, key=lambda made: made.error).recordings
    return best if _explains(model, best) else None


def made_by_mujoco(
    model: Model, usual: Sequence[Recording], given: Sequence[Recording]
) -> list[MadeByMujoco]:
    """Return recordings taken as made by MuJoCo, by each way that may be right.

    Args:
        model: that runs.
        usual: the recordings with assumptions about their loop, as those of a machine.
        given: the recordings without any.

    Returns:
        none where models run neither in a loop nor along the measured motion, and where the file of a model
        is not all of its machine.
    """
    replay, out = replay_of(model, usual), []
    if model.posture_dependent or model.carried is not None:
        return out
    if not isinstance(replay, ClosedLoop | InverseDynamicsReplay):
        return out
    measured = replay.recordings
    counts, names = [int(np.sum(r.valid)) for r in measured], [scored_signals(r) for r in measured]
    (run,) = replay.run([model])
    usual_error, _ = score_runs(measured, run)
    for way in by_mujoco(model, given):
        taken = _likely(model, readings(model, way))[0]
        there = replay_of(model, taken)
        if type(there) is not type(replay):
            continue
        (other,) = there.run([model])
        change = pooled([squares(*each) for each in zip(run, other, names, strict=True)], counts)
        out.append(MadeByMujoco(taken, score_runs(measured, other)[0], usual_error, change))
    return [made for made in out if np.isfinite(made.error)]


def _explains(model: Model, recordings: Sequence[Recording]) -> bool:
    return evaluate(model, replay_of(model, recordings).with_noise(model, 0)).consistent


def _likely(model: Model, ways: Sequence[LoopAssumption]) -> tuple[tuple[Recording, ...], ...]:
    """Recordings by those readings of their logs that may be right, the likeliest first.

    Where the torque left several open, the model is run by each: if it explains the recordings by some,
    these are the ones. A model that is wrong as well explains them by none, and all are left.
    """
    if len(ways) == 1:
        return (noted(ways[0]),)
    replays = [replay_of(model, way.recordings) for way in ways]
    errors = np.array([_error(replay, model) for replay in replays])
    order = np.argsort(errors, kind="stable")
    best = int(order[0])
    if np.isfinite(errors[best]):
        result = evaluate(model, replays[best].with_noise(model, 0))
        if result.consistent:
            most = max(MARGIN_TOTAL * result.noise_error, errors[best])
            kept = [ways[k] for k in order if errors[k] <= most]
            held, speed = (len({way.answer[i] for way in kept}) == 1 for i in (0, 1))
            return tuple(
                noted(
                    replace(
                        way,
                        sure_between_rows=way.sure_between_rows or held,
                        sure_of_speed=way.sure_of_speed or speed,
                    )
                )
                for way in kept
            )
    return tuple(noted(ways[k]) for k in order)


def _error(replay: Replay, model: Model) -> float:
    """The score of a model's run without noise; infinite where it cannot be run."""
    (runs,) = replay.run([model])
    error, _ = score_runs(replay.recordings, runs)
    return error if np.isfinite(error) else np.inf
