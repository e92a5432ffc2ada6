"""Simulates models as recordings were made, any number of runs together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.core import InputError, Recording, Recordings, SimulationError, Timing
from workbench.effects import Plant
from workbench.inspection.torque import command_limits
from workbench.models import Model

from .control import SensorNoise, control_law
from .cores import on_all_cores
from .drives import drives_of
from .experiment import Experiment, prepare
from .sense import logged, sensors_of
from .steps import Steps, as_made, steps_of
from .trajectory import TRUE_MOTION
from .unstable import raise_where_unstable
from .world import march, world_of


@dataclass(frozen=True)
class Run:
    """One model on one recording.

    Attributes:
        model, recording: what runs, and how.
        noise: with it, sensors are noisy and the noise goes round the loop.
        start: position and rate (2, n) at the first row, the recording's coordinates; without it, as the
            recording and its loop say.
    """

    model: Model
    recording: Recording
    noise: SensorNoise | None = None
    start: np.ndarray | None = None

    def __post_init__(self) -> None:
        for given, kind in ((self.model, Model), (self.recording, Recording)):
            if not isinstance(given, kind):
                raise InputError(
                    f"a {kind.__name__} is expected, not a value of type {type(given).__name__}",
                    remedy="give Run(model, recording); load_model and load_recording read files",
                )


def simulate(runs: Run | Sequence[Run], *, strict: bool = True) -> Recordings:
    """Return all simulated runs: same references, controller, sampling, delay, torque, initial state.

    Args:
        runs: one or several, any mixture of models and recordings; they run on all cores.
        strict: raise where a simulation becomes unstable; else its signals are NaN from there, and all of
            them where the model cannot be compiled.

    Returns:
        One recording a run, in the coordinates of its own: position, velocity, torque_command and
        torque_measured as the log would show them (without sensor noise unless the run has it). Where
        sensors err, `extra` holds the motion that was made, under the names of `TRUE_MOTION`.

    Raises:
        InputError: something else than runs.
        SimulationError: unstable (with `strict`), naming model, recording and time.
    """
    runs = [runs] if isinstance(runs, Run) else runs
    if not (isinstance(runs, Iterable) and all(isinstance(run, Run) for run in runs)):
        raise InputError("runs are expected", remedy="give Run(model, recording), or a list of them")
    experiments = [_prepared(run, run.model) for run in runs]
    keys = [(id(run.model), steps_of(run.recording, run.model), run.recording.timing) for run in runs]
    compiled: dict[tuple[int, Steps, Timing], Plant | None] = {}
    for run, key in zip(runs, keys, strict=True):
        if key not in compiled:
            compiled[key] = _compiled(run, key[1], strict)
    plants = [compiled[key] for key in keys]
    results: list[Recording | None] = [None] * len(runs)
    # the longest first, so that no core is left alone with one at the end
    order = sorted(range(len(runs)), key=lambda i: -experiments[i].substeps)
    made = on_all_cores(lambda i: _run(runs[i], experiments[i], plants[i]), order)
    for i, recording in zip(order, made, strict=True):
        results[i] = recording
    out = [r for r in results if r is not None]
    if strict:
        for run, e, recording in zip(runs, experiments, out, strict=True):
            raise_where_unstable(run.model, run.recording, e.controller, recording, partial(_again, run=run))
    return Recordings(out)


def _compiled(run: Run, steps: Steps, strict: bool) -> Plant | None:
    """The model's plant; None where it cannot be had and need not."""
    try:
        return steps.compiled(as_made(run.model, run.recording))
    except SimulationError:
        if strict:
            raise
        return None


def _prepared(run: Run, model: Model) -> Experiment:
    """The experiment of a run, from where it begins."""
    e = prepare(run.recording, model)
    if run.start is None:
        return e
    return replace(e, start=run.start @ (np.linalg.inv(e.transmission) @ e.to_actuator).T)


def _again(model: Model, run: Run) -> Recording:
    """Another model, run the same way."""
    experiment = _prepared(run, model)
    plant = steps_of(run.recording, model).compiled(as_made(model, run.recording))
    return _run(replace(run, model=model), experiment, plant)


def _run(run: Run, e: Experiment, plant: Plant | None) -> Recording:
    """One run: its loop marched through, and what the log shows, in the coordinates of its recording."""
    if plant is None:
        lost = np.full_like(run.recording.position, np.nan)
        names = ("position", "velocity", "torque_command", "torque_measured")
        return _shown(run.recording, dict.fromkeys(names, lost), {})
    n, substeps = plant.model.size, e.substeps
    drives = drives_of(e, plant)
    sensors, start = sensors_of(e, plant)
    world, keep = world_of(plant, start)
    pad = drives.whole + 1
    command, torque = np.zeros((pad + substeps + 1, n)), np.zeros((substeps + 1, n))
    command[:pad] = e.before
    position, velocity = np.full((2, substeps + 1, n), np.nan)
    position[0], velocity[0] = start
    control = control_law(e, plant, run.noise)
    march(world, control, drives, sensors, pad, command, torque, position, velocity)
    del keep
    rows = slice(None, None, e.stride)
    to_rows = np.linalg.inv(e.to_actuator)
    seen, rate = position[rows].copy(), velocity[rows].copy()
    logged(sensors, e.stride, seen, rate)
    seen, rate = seen @ to_rows.T, rate @ to_rows.T
    asked = command[pad:][rows]
    if e.controller.kind != "none" and command_limits(run.recording):
        asked = np.clip(asked, -plant.chain.limit, plant.chain.limit)  # logged behind the limit
    asked = asked @ e.to_actuator
    tap = torque[rows] @ e.to_actuator
    if run.recording.timing.delay == "loop":
        asked = tap
    if run.noise is not None:
        seen, rate, tap = run.noise.logged(seen, rate, tap)
    signals = {"position": seen, "velocity": rate, "torque_command": asked, "torque_measured": tap}
    true = () if sensors.honest else (position[rows], velocity[rows])
    extra = {name: v @ to_rows.T for name, v in zip(TRUE_MOTION, true, strict=False)}
    return _shown(run.recording, signals, extra)


def _shown(recording: Recording, signals: dict[str, np.ndarray], extra: dict[str, np.ndarray]) -> Recording:
    return replace(recording, signals=signals, extra=extra, derived=(), notes=(), source=None)
