"""How recordings are replayed on models: round the loop that made them, or along the measured motion."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np

from workbench.core import InputError, Recording, SimulationError
from workbench.effects import Motion, Plant, compile_plant, effect_named
from workbench.models import Model
from workbench.simulation import (
    Disturbance,
    Loop,
    Run,
    SensorNoise,
    Track,
    linearise,
    motion_of,
    prepare,
    propagate,
    scored_torque,
    simulate,
    smooth_track,
)

from .band import corner_hz
from .counted_rows import moving, settled
from .drift import drifts
from .grounded import Grounded
from .inverse import cutoff_hz
from .measured_motion import Follower, Reading, noisy, quiet, read_motion
from .noise import DRAWS, NoiseModel, noise_seeds
from .simulated import Simulated
from .standing import on_ground


class Replay(Protocol):
    """Recordings and a way to run any model on them."""

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """What is replayed, with loops as they are taken."""
        ...

    @property
    def noise(self) -> NoiseModel:
        """The sensors."""
        ...

    #: Whether contacts with the ground are replayed, so that derivatives take simulations.
    on_ground: ClassVar[bool]

    def shows(self, effect: str) -> bool:
        """Whether it can tell anything of an effect."""
        ...

    def like(self, model: Model, recordings: Sequence[Recording]) -> Replay:
        """The same sensors and the same kind of replay for other recordings."""
        ...

    def only(self, chosen: Sequence[int]) -> Replay:
        """The same for some of the recordings."""
        ...

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Noise-free runs of the `first` recordings (all), one list a model; NaN where it cannot be run."""
        ...

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Runs of one model, without noise and with it."""
        ...

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """The motion of one recording, given a model's run of it."""
        ...

    def loop(self, plant: Plant, index: int, motion: Motion) -> Any:
        """How small changes travel along a motion: what `propagate` takes."""
        ...

    def propagate(
        self, loops: Sequence[Any], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Response of position and compared torque, (N, n, C) each, per loop."""
        ...


def replay_of(model: Model, recordings: Sequence[Recording], noise: NoiseModel | None = None) -> Replay:
    """How these recordings can be held against models like this one.

    Where one is on the ground, all run in short windows; where one loop is unknown, or open and drifting,
    all are replayed along their measured motion: so that one score counts.

    Raises:
        InputError: a loop is unknown and no torque was recorded.
    """
    noise = noise or NoiseModel.of(recordings)
    if any(map(on_ground, recordings)):
        return Grounded(model, recordings, noise)
    if not any(needs_inverse(model, r) for r in recordings) and not drifts(model, recordings):
        known = _closed(model, recordings)
        return ClosedLoop(known, noise.with_unlogged_rate([prepare(r, model) for r in known]))
    blind = next((r for r in recordings if scored_torque(r) is None), None)
    if blind is not None:
        raise InputError(
            "neither the loop nor a torque is known", file=blind.source, column="controller",
            remedy="describe the controller, or name the column of the torque",
        )  # fmt: skip
    return MeasuredMotion(_followed(recordings), noise, model)


def _closed(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    return tuple(
        replace(r, controller=model.controller) if r.controller.kind == "unknown" else r
        for r in map(settled, recordings)
    )


def _followed(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    return tuple(map(_along, recordings))


def _along(recording: Recording) -> Recording:
    note = "Nothing holds the machine, and its run drifts: the torque along the measured motion is compared."
    notes = (*recording.notes, note) if recording.controller.kind == "none" else recording.notes
    return replace(recording, controller=replace(recording.controller, kind="unknown"), notes=notes)


def needs_inverse(model: Model, recording: Recording) -> bool:
    """Whether a recording's loop is unknown, so that only inverse dynamics can be compared."""
    known = recording.controller.kind != "unknown"
    return not known and (model.controller.kind == "unknown" or recording.get("position_reference") is None)


@dataclass(frozen=True)
class ClosedLoop:
    """Every model runs the way the recordings were made; position and torque are scored."""

    recordings: tuple[Recording, ...]
    noise: NoiseModel
    on_ground: ClassVar[bool] = False

    def shows(self, effect: str) -> bool:
        """Off the ground, all but contacts with it."""
        return not effect_named(effect).of_ground

    def like(self, model: Model, recordings: Sequence[Recording]) -> ClosedLoop:
        """The same for other recordings."""
        return ClosedLoop(_closed(model, recordings), self.noise)

    def only(self, chosen: Sequence[int]) -> ClosedLoop:
        """The same for some of the recordings."""
        return replace(self, recordings=tuple(self.recordings[i] for i in chosen))

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """All models on all recordings in one batch."""
        part = self.recordings[:first]
        count = len(part)
        made = simulate([Run(m, r) for m in models for r in part], strict=False)
        return [tuple(made[k * count : (k + 1) * count]) for k in range(len(models))]

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Noise goes round the sampled loop.

        Raises:
            SimulationError: the model is unstable in a recording's loop.
        """
        runs = [Run(model, r) for r in self.recordings]
        for seeds in noise_seeds(len(self.recordings), draws, seed):
            runs += [Run(model, r, self.noise.draw(s)) for r, s in zip(self.recordings, seeds, strict=True)]
        made, count = simulate(runs), len(self.recordings)
        noisy = tuple(tuple(made[count * (d + 1) : count * (d + 2)]) for d in range(draws))
        return Simulated(self.recordings, tuple(made[:count]), noisy, self.noise)

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """The run, corrected by what the sensors say of it."""
        r, levels = self.recordings[index], self.noise.levels
        to_actuator = prepare(r, plant.model).to_actuator
        usable = run if np.isfinite(run.position).all() else None
        track = smooth_track(r, usable, to_actuator, levels.position_std, levels.velocity_std)
        return motion_of(track, r, plant, to_actuator)

    def loop(self, plant: Plant, index: int, motion: Motion) -> Loop:
        """The loop linearised about the motion."""
        track = Track(motion.position, motion.velocity, motion.acceleration)
        return linearise(plant, prepare(self.recordings[index], plant.model), track, motion.gain)

    def propagate(
        self, loops: Sequence[Any], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Round the sampled loops, side by side."""
        return propagate(loops, disturbances)


class MeasuredMotion:
    """Every model follows the motion that was measured; the torque that it needs is scored.

    The position is taken from the recording, so that it says nothing of the model. Rows at the edges, where
    differentiating errs, and axes while they stand still, where dry friction takes any value, do not count.
    """

    on_ground: ClassVar[bool] = False

    def __init__(
        self, recordings: tuple[Recording, ...], noise: NoiseModel, model: Model, corner: float | None = None
    ) -> None:
        self.recordings, self.noise, self._transmission = recordings, noise, model.transmission
        plant = compile_plant(model)
        self._corner = corner or min(corner_hz(r, plant, noise.levels) for r in recordings)
        first = [self._reading(r) for r in recordings]
        smooth = [self._reading(quiet(r)) for r in first]
        again = self._seen(smooth, [noise.draw(k) for k in range(len(smooth))])
        wobbles = [a.track.velocity - s.track.velocity for a, s in zip(again, smooth, strict=True)]
        counts = moving(first, wobbles, self._transmission)
        self._read, self._smooth = (
            [replace(r, counts=c) for r, c in zip(each, counts, strict=True)] for each in (first, smooth)
        )
        self._drawn: dict[tuple[int, int], list[list[Reading]]] = {}

    def shows(self, effect: str) -> bool:
        """Off the ground, all but contacts with it."""
        return not effect_named(effect).of_ground

    def like(self, model: Model, recordings: Sequence[Recording]) -> MeasuredMotion:
        """The same, with the same filter, for other recordings of the same kind."""
        return MeasuredMotion(_followed(recordings), self.noise, model, self._corner)

    def only(self, chosen: Sequence[int]) -> MeasuredMotion:
        """The same for some of the recordings."""
        part = copy.copy(self)
        part.recordings = tuple(self.recordings[i] for i in chosen)
        part._read, part._smooth = ([each[i] for i in chosen] for each in (self._read, self._smooth))
        part._drawn = {}
        return part

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """The recordings with the torque that each model needs in place of that measured."""
        plants = [_compiled(m) for m in models]
        return [tuple(reading.run(p) for reading in self._read[:first]) for p in plants]

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Noise of position, velocity and torque goes through differentiation, model and filter.

        Raises:
            SimulationError: a model that no body can be.
        """
        plant = compile_plant(model)
        clean = tuple(reading.run(plant) for reading in self._read)
        still = [s.residual(plant) for s in self._smooth]
        noisy = []
        generator = np.random.default_rng([seed, 5])
        for draw in self._draws(seed, draws):
            runs = []
            for base, quiet_rest, seen in zip(clean, still, draw, strict=True):
                moved = base.signals[seen.name] + seen.residual(plant) - quiet_rest + seen.slack(generator)
                runs.append(base.with_signals(**{seen.name: moved}))
            noisy.append(tuple(runs))
        return Simulated(self.recordings, clean, tuple(noisy), self.noise)

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """The motion that was measured, whatever the run."""
        del run
        return self._read[index].motion(plant)

    def loop(self, plant: Plant, index: int, motion: Motion) -> Follower:
        """What a torque along the motion changes."""
        return Follower(self._read[index], plant, motion)

    def propagate(
        self, loops: Sequence[Follower], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Through the filter, and nothing else."""
        return [loop.respond(d) for loop, d in zip(loops, disturbances, strict=True)]

    def _reading(self, recording: Recording) -> Reading:
        corner = min(self._corner, cutoff_hz(recording))
        return read_motion(recording, self._transmission, self.noise.levels, corner)

    def _seen(self, smooth: Sequence[Reading], noises: Sequence[SensorNoise]) -> list[Reading]:
        """Smooth readings as noisy sensors would have shown them."""
        seen = [self._reading(noisy(s.recording, n, s.name)) for s, n in zip(smooth, noises, strict=True)]
        return [replace(r, counts=s.counts) for r, s in zip(seen, smooth, strict=True)]

    def _draws(self, seed: int, draws: int) -> list[list[Reading]]:
        if (seed, draws) not in self._drawn:
            self._drawn[seed, draws] = [
                self._seen(self._smooth, [self.noise.draw(s) for s in seeds])
                for seeds in noise_seeds(len(self.recordings), draws, seed)
            ]
        return self._drawn[seed, draws]


def _compiled(model: Model) -> Plant | None:
    """None where MuJoCo refuses the model."""
    try:
        return compile_plant(model)
    except SimulationError:
        return None
