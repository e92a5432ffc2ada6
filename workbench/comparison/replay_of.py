"""Selects one of the four kinds of replay for given recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import InputError, Recording
from workbench.models import Model
from workbench.simulation import prepare, refuse_joint_coordinates, scored_torque

from .by_posture import ByPosture
from .closed_loop import ClosedLoop, with_loops
from .drift import drifts
from .following import InverseDynamicsReplay, followed
from .grounded import ContactWindows
from .noise import NoiseModel
from .replay import Replay
from .standing import on_ground
from .swings import FreeDecay, is_free

_CARRIED = "The transmission changes with the posture"
_NAME = "name the column of the torque"
_MOVES = 20.0  # times a position's noise, over which it ranges where an axis moves


def replay_of(model: Model, recordings: Sequence[Recording], noise: NoiseModel | None = None) -> Replay:
    """Return the replay with which these recordings can be compared with models like this one.

    Where one is on the ground, all run in short windows; where one loop is unknown, or open and drifting,
    all are replayed along their measured motion: so that one score counts. What nothing drives runs swing by
    swing.

    Raises:
        InputError: a loop is unknown and no torque was recorded, or none but zeros although axes move.
    """
    noise = noise or NoiseModel.of(recordings)
    if model.posture_dependent:
        return ByPosture.of(model, recordings, noise)
    if model.carried is not None:
        for each in recordings:
            refuse_joint_coordinates(each)
        why = f"no torque is known. {_CARRIED}, and then only the torque shows effects"
        _refuse_blind(recordings, why, _NAME)
        return InverseDynamicsReplay(followed(recordings, _CARRIED), noise, model)
    if any(map(on_ground, recordings)):
        return ContactWindows(model, recordings, noise)
    if all(map(is_free, recordings)):
        return FreeDecay(recordings, noise)
    if not any(needs_inverse(model, r) for r in recordings) and not drifts(model, recordings):
        known = with_loops(model, recordings)
        return ClosedLoop(known, noise.with_unlogged_rate([prepare(r, model) for r in known]))
    _refuse_blind(
        recordings, "neither the loop nor a torque is known", f"describe the controller, or {_NAME}"
    )
    _refuse_undriven(model, recordings, noise)
    return InverseDynamicsReplay(followed([_with_stated(model, r) for r in recordings]), noise, model)


def _refuse_blind(recordings: Sequence[Recording], why: str, remedy: str) -> None:
    blind = next((r for r in recordings if scored_torque(r) is None), None)
    if blind is not None:
        raise InputError(why, file=blind.source, column="controller", remedy=remedy)


def _refuse_undriven(model: Model, recordings: Sequence[Recording], noise: NoiseModel) -> None:
    """Refuse a motion of an unknown loop whose torque stays zero: it could be compared with nothing else."""
    for r in recordings:
        name = scored_torque(r)
        if name is None or not needs_inverse(model, r) or r.signals[name][r.valid].any():
            continue
        if np.any(np.ptp(r.position[r.valid], axis=0) > _MOVES * np.nan_to_num(noise.levels.position_std)):
            raise InputError(
                f"axes move although {name} is zero in every row, and the controller is not known",
                file=r.source, column="controller",
                remedy=f'if nothing drives the machine, state kind = "none" in [controller]; else {_NAME}',
            )  # fmt: skip


def needs_inverse(model: Model, recording: Recording) -> bool:
    """Return whether the loop of a recording is unknown, so that only inverse dynamics can be compared."""
    known = recording.controller.kind != "unknown"
    return not known and (model.controller.kind == "unknown" or recording.get("position_reference") is None)


def _with_stated(model: Model, recording: Recording) -> Recording:
    """With the model's loop where the recording states none and could be run in that: so it is known."""
    known = recording.controller.kind != "unknown" or needs_inverse(model, recording)
    return recording if known else replace(recording, controller=model.controller)
