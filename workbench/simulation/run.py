"""Run models the way recordings were made: one pass over time, any number of runs side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.effects import compile_plant
from workbench.models import Model

from .control import Controllers, SensorNoise
from .experiment import Experiment, prepare
from .world import Worlds, group_worlds


@dataclass(frozen=True)
class Run:
    """One model on one recording; with `noise`, sensors are noisy and the noise goes round the loop."""

    model: Model
    recording: Recording
    noise: SensorNoise | None = None


def simulate(runs: Sequence[Run], *, strict: bool = True) -> list[Recording]:
    """Simulate every run: same references, controller, sampling, delay, injected torque, initial state.

    Args:
        runs: any mixture of models and recordings; they are stepped together on all cores.
        strict: raise where a simulation becomes unstable; else its signals are NaN from there.

    Returns:
        One recording a run, in the coordinates of its own: position, velocity, torque_command and
        torque_measured as the log would show them (without sensor noise unless the run has it).

    Raises:
        SimulationError: unstable (with `strict`), naming model, recording and time.
    """
    results: list[Recording | None] = [None] * len(runs)
    experiments = [prepare(run.recording, run.model) for run in runs]
    clocks = [(round(e.step, 12), run.model.size) for e, run in zip(experiments, runs, strict=True)]
    for clock in sorted(set(clocks)):
        chosen = [i for i, own in enumerate(clocks) if own == clock]
        # longest first, so that the runs still going are always a prefix
        chosen.sort(key=lambda i: -experiments[i].substeps)
        part = _march([runs[i] for i in chosen], [experiments[i] for i in chosen], strict)
        for index, recording in zip(chosen, part, strict=True):
            results[index] = recording
    return [r for r in results if r is not None]


def _march(runs: list[Run], experiments: list[Experiment], strict: bool) -> list[Recording]:
    step = experiments[0].step
    plants = {id(r.model): r.model for r in runs}
    compiled = {key: compile_plant(model, step) for key, model in plants.items()}
    worlds = group_worlds([compiled[id(r.model)] for r in runs], experiments)
    controllers = Controllers(
        runs[0].model.size, experiments, [r.noise for r in runs], [r.model for r in runs]
    )
    total = np.array([e.substeps for e in experiments])
    boundaries = np.unique(np.concatenate([*(e.ticks for e in experiments), np.unique(total)]))
    trace = _Trace(worlds, controllers, int(total[0]))
    for first, last in pairwise(boundaries):
        active = int(np.searchsorted(-total, -first, side="left"))
        trace.advance(int(first), int(last), active)
    if strict:
        trace.raise_where_unstable(runs, step)
    return [trace.recording(i, run, e) for i, (run, e) in enumerate(zip(runs, experiments, strict=True))]


class _Trace:
    """State, command and torque of every run over all substeps; filled chunk by chunk."""

    def __init__(self, worlds: Worlds, controllers: Controllers, substeps: int) -> None:
        count, n = worlds.count, worlds.size
        self.worlds, self.controllers = worlds, controllers
        self.pad = worlds.longest_delay + 1
        self.position = np.full((count, substeps + 1, n), np.nan)
        self.velocity = np.full((count, substeps + 1, n), np.nan)
        self.command = np.zeros((count, self.pad + substeps + 1, n))
        self.torque = np.zeros((count, substeps + 1, n))
        self.position[:, 0], self.velocity[:, 0] = worlds.start[:, 0], worlds.start[:, 1]

    def advance(self, first: int, last: int, active: int) -> None:
        """Sample the controllers at substep `first` and step to `last`."""
        held = slice(self.pad + first, self.pad + last + 1)
        now = self.controllers.sample(
            first, last, active, self.position[:active, first], self.velocity[:active, first]
        )
        self.command[:active, held] = now
        tap, torque = self.worlds.chain(self.command, first, last, active, self.pad)
        self.torque[:active, first : last + 1] = tap
        q, w = self.worlds.step(torque, active)
        self.position[:active, first + 1 : last + 1] = q
        self.velocity[:active, first + 1 : last + 1] = w

    def raise_where_unstable(self, runs: list[Run], step: float) -> None:
        """Name the first run whose state is not finite."""
        for i, run in enumerate(runs):
            span = self.position[i, : self.controllers.experiments[i].substeps + 1]
            bad = ~np.isfinite(span).all(axis=1)
            if bad.any():
                effects = ", ".join(str(e.key) for e in run.model.effects) or "no effects"
                raise SimulationError(
                    f"model '{run.model.name}' ({effects}) becomes unstable on recording "
                    f"'{run.recording.name}' at {np.argmax(bad) * step:.3f} s; "
                    "check its parameters, the controller gains and the delay"
                )

    def recording(self, i: int, run: Run, e: Experiment) -> Recording:
        """The rows of run `i`, in the coordinates of its recording."""
        rows = slice(0, e.substeps + 1, e.stride)
        to_rows = np.linalg.inv(e.to_actuator) @ run.model.transmission
        position = self.position[i, rows] @ to_rows.T
        velocity = self.velocity[i, rows] @ to_rows.T
        command = self.command[i, self.pad :][rows] @ e.to_actuator
        torque = self.torque[i, rows] @ e.to_actuator
        if run.recording.timing.delay == "loop":
            command = torque
        if run.noise is not None:
            position, velocity, torque = run.noise.logged(position, velocity, torque)
        signals = {
            "position": position,
            "velocity": velocity,
            "torque_command": command,
            "torque_measured": torque,
        }
        return replace(
            run.recording,
            signals=signals,
            extra={},
            derived=(),
            notes=(),
            name=run.recording.name,
            source=None,
        )
