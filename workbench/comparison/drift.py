"""Open loops that drift: one per cent of the torque decides where the run ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import Recording
from workbench.models import Model
from workbench.simulation import Run, scored_torque, simulate

_PART = 0.01  # of a torque's root mean square: no drive's constant and no bearing is known better
_AWAY = 2.0  # deviations of the measured position from its own drift, by which that may move a run
_DRIFT = 2  # order: what a constant torque does to a free shaft
_TORQUES = ("torque_command", "torque_measured", "torque_feedforward")


def drifts(model: Model, recordings: Sequence[Recording]) -> bool:
    """Return whether an open-loop simulation of one of the recordings diverges from the measurement for
    every model.

    Nothing holds a free shaft: a little constant torque moves it further, run for seconds, than the
    excitation did, and its position says more of that than of the machine. The torque along the measured
    motion does not drift. What effects the model has makes no difference here, so that a model and its
    improvement are judged alike.
    """
    open_loops = [r for r in recordings if r.controller.kind == "none" and scored_torque(r) is not None]
    bare = replace(model, effects=tuple(e for e in model.effects if not e.parameters))
    runs = [Run(bare, r) for r in open_loops for r in (r, _pushed(r))]
    made = simulate(runs, strict=False)
    for r, (first, second) in zip(open_loops, zip(made[::2], made[1::2], strict=True), strict=True):
        apart = np.sqrt(np.mean((second.position - first.position)[r.valid] ** 2, axis=0))
        if not (apart <= _AWAY * _excited(r)).all():
            return True
    return False


def _excited(recording: Recording) -> np.ndarray:
    """Deviation (n,) of the measured positions from a smooth drift [rad or m]."""
    time, position = recording.time[recording.valid], recording.position[recording.valid]
    middle = time - time.mean()
    return (position - np.vander(middle, _DRIFT + 1) @ np.polyfit(middle, position, _DRIFT)).std(axis=0)


def _pushed(recording: Recording) -> Recording:
    """The recording with a little more of every torque that may drive its replay, (N, n)."""
    given = {name: recording.signals[name] for name in _TORQUES if recording.get(name) is not None}
    size = next(np.sqrt(np.mean(given[name] ** 2, axis=0)) for name in _TORQUES if name in given)
    return recording.with_signals(**{name: torque + _PART * size for name, torque in given.items()})
