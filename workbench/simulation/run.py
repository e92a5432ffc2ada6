"""Run models the way recordings were made: one pass over time, any number of runs side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.effects import Plant, compile_plant
from workbench.models import Model

from .control import Controllers, SensorNoise
from .drives import Drives
from .experiment import Experiment, prepare
from .sense import Sensors
from .trajectory import TRUE_MOTION
from .world import group_worlds


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
        torque_measured as the log would show them (without sensor noise unless the run has it). Where
        sensors err, `extra` holds the motion that was made, under the names of `TRUE_MOTION`.

    Raises:
        SimulationError: unstable (with `strict`), naming model, recording and time.
    """
    results: list[Recording | None] = [None] * len(runs)
    experiments = [prepare(run.recording, run.model) for run in runs]
    compiled: dict[tuple[int, float], Plant] = {}
    for run, e in zip(runs, experiments, strict=True):
        if (id(run.model), e.step) not in compiled:
            compiled[id(run.model), e.step] = compile_plant(run.model, e.step)
    plants = [compiled[id(run.model), e.step] for run, e in zip(runs, experiments, strict=True)]
    # runs whose torque follows the speed go step by step, and must not hold up the others
    clocks = [
        (round(e.step, 12), p.model.size, p.chain.follows_speed)
        for e, p in zip(experiments, plants, strict=True)
    ]
    for clock in sorted(set(clocks)):
        chosen = [i for i, own in enumerate(clocks) if own == clock]
        # longest first, so that the runs still going are always a prefix
        chosen.sort(key=lambda i: -experiments[i].substeps)
        part = _march(
            [runs[i] for i in chosen], [experiments[i] for i in chosen], [plants[i] for i in chosen], strict
        )
        for index, recording in zip(chosen, part, strict=True):
            results[index] = recording
    return [r for r in results if r is not None]


def _march(
    runs: list[Run], experiments: list[Experiment], plants: list[Plant], strict: bool
) -> list[Recording]:
    total = np.array([e.substeps for e in experiments])
    boundaries = np.unique(np.concatenate([*(e.ticks for e in experiments), np.unique(total)]))
    if plants[0].chain.follows_speed:
        boundaries = np.arange(total[0] + 1)
    trace = _Trace(runs, experiments, plants)
    for first, last in pairwise(boundaries):
        active = int(np.searchsorted(-total, -first, side="left"))
        trace.advance(int(first), int(last), active)
    if strict:
        trace.raise_where_unstable(runs)
    return [trace.recording(i, run, e) for i, (run, e) in enumerate(zip(runs, experiments, strict=True))]


class _Trace:
    """Motion of the drives, command and torque of every run over all substeps; filled chunk by chunk."""

    def __init__(self, runs: list[Run], experiments: list[Experiment], plants: list[Plant]) -> None:
        count, n, substeps = len(runs), plants[0].model.size, experiments[0].substeps
        self.experiments = experiments
        self.sensors = Sensors(plants, experiments)
        # what the log shows first is where the run starts; the truth may differ by the sensors' errors
        self.worlds = group_worlds(plants, self.sensors.true_start)
        self.drives = Drives(plants, experiments)
        self.controllers = Controllers(n, experiments, [r.noise for r in runs], plants)
        self.pad = self.drives.longest_delay + 1
        self.position, self.velocity = self.sensors.position, self.sensors.velocity
        self.command = np.zeros((count, self.pad + substeps + 1, n))
        self.torque = np.zeros((count, substeps + 1, n))

    def advance(self, first: int, last: int, active: int) -> None:
        """Sample the controllers at substep `first` and step to `last`."""
        held = slice(self.pad + first, self.pad + last + 1)
        seen = self.sensors.read(first, active)
        self.command[:active, held] = self.controllers.sample(first, last, active, *seen)
        speed = self.velocity[:active, first]
        passed = self.drives.pass_on(self.command, first, last, active, self.pad, speed)
        self.torque[:active, first : last + 1] = passed.tap
        q, w = self.worlds.step(passed.shaft, passed.early, active)
        self.sensors.record(first, last, q, w)

    def raise_where_unstable(self, runs: list[Run]) -> None:
        """Name the first run whose state is not finite."""
        for i, (run, e) in enumerate(zip(runs, self.experiments, strict=True)):
            span = self.position[i, : e.substeps + 1]
            bad = ~np.isfinite(span).all(axis=1)
            if bad.any():
                effects = ", ".join(str(e.key) for e in run.model.effects) or "no effects"
                raise SimulationError(
                    f"model '{run.model.name}' ({effects}) becomes unstable on recording "
                    f"'{run.recording.name}' at {np.argmax(bad) * e.step:.3f} s; "
                    "check its parameters, the controller gains and the delay"
                )

    def recording(self, i: int, run: Run, e: Experiment) -> Recording:
        """The rows of run `i`, in the coordinates of its recording."""
        rows = slice(0, e.substeps + 1, e.stride)
        to_rows = np.linalg.inv(e.to_actuator)
        position, velocity = (seen @ to_rows.T for seen in self.sensors.log(i, rows))
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
        true = () if self.sensors.honest else (self.position[i, rows], self.velocity[i, rows])
        return replace(
            run.recording,
            signals=signals,
            extra={name: v @ to_rows.T for name, v in zip(TRUE_MOTION, true, strict=False)},
            derived=(),
            notes=(),
            name=run.recording.name,
            source=None,
        )
