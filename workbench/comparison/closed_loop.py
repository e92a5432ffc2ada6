"""Recordings with known loops: every model is simulated as the recordings were made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Recording
from workbench.effects import Motion, Plant, effect_named, kinds
from workbench.models import Model, own_friction
from workbench.simulation import (
    Disturbance,
    Loop,
    Run,
    Track,
    linearise,
    motion_of,
    prepare,
    propagate,
    simulate,
    smooth_track,
)

from .counted_rows import settled
from .noise import DRAWS, NoiseModel, noise_seeds
from .noise_by_rest import noise_by_rest, reads_unlogged_speed
from .replay import Replay
from .simulated import Simulated

_SHIFT, _LONGEST = 0.05, 0.002  # of a period; s
_CREEP = 4.0  # times the sliding speed: where tanh(w / 1 mrad/s), a usual law, holds nearly all of its torque


def with_loops(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the recordings without their transients; those that do not state their loop take that of the
    model.
    """
    return tuple(
        replace(r, controller=model.controller) if r.controller.kind == "unknown" else r
        for r in map(settled, recordings)
    )


def late_by(recording: Recording) -> float:
    """Return the fraction of a tick [s] by which simulators disagree on when a torque acts."""
    return _SHIFT * min(recording.controller.period_s or recording.period, recording.period, _LONGEST)


def _shifted(model: Model, recording: Recording) -> Model:
    """The same machine a fraction of a tick later: where in a step torque acts, simulators do not agree."""
    later = model.actuators.delay_s + late_by(recording)
    return replace(model, actuators=replace(model.actuators, delay_s=later))


def _creeping(model: Model) -> Model:
    """The same machine whose dry friction gives way a little sooner: nor do simulators agree at rest."""
    return replace(model, sliding_speed=_CREEP * model.sliding_speed)


def _is_dry(model: Model) -> bool:
    """Whether any friction of it sticks, as its file states it or as an effect."""
    added = any(kinds.is_dry(effect_named(a.key.effect)) for a in model.effects)
    return added or bool(own_friction(model))


@dataclass(frozen=True)
class ClosedLoop(Replay[Loop]):
    """A replay that simulates every model as the recordings were made, and scores position and torque."""

    recordings: tuple[Recording, ...]
    noise: NoiseModel

    def like(self, model: Model, recordings: Sequence[Recording]) -> ClosedLoop:
        """Return the same replay for other recordings."""
        return ClosedLoop(with_loops(model, recordings), self.noise)

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Return the runs of all models on all recordings, simulated in one batch."""
        part = self.recordings[:first]
        count = len(part)
        made = simulate([Run(m, r) for m in models for r in part], strict=False)
        return [tuple(made[k * count : (k + 1) * count]) for k in range(len(models))]

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Return runs of one model without and with sensor noise, which passes through the sampled loop.

        Raises:
            SimulationError: the model is unstable in a recording's loop.
        """
        count, seeds = len(self.recordings), noise_seeds(len(self.recordings), draws, seed)
        noise, still = self.noise, [Run(model, r) for r in self.recordings]
        made = simulate([*still, *self._drawn(model, noise, seeds[0])])
        clean, noisy = tuple(made[:count]), [tuple(made[count:])]
        by_rest = self._by_rest(model, clean, noisy[0], seeds[0])
        if by_rest is not noise:
            noise, noisy = by_rest, []
        more = [run for own in seeds[len(noisy) :] for run in self._drawn(model, noise, own)]
        made = simulate(more)
        noisy += [tuple(made[k : k + count]) for k in range(0, len(made), count)]
        late = [Run(_shifted(model, r), r) for r in self.recordings]
        creeping = [Run(_creeping(model), r) for r in self.recordings] if _is_dry(model) else []
        alike = tuple(simulate([*late, *creeping], strict=False))
        return Simulated(self.recordings, clean, tuple(noisy), noise, alike[:count], alike[count:])

    def _drawn(self, model: Model, noise: NoiseModel, seeds: Sequence[int]) -> list[Run]:
        return [Run(model, r, noise.draw(s)) for r, s in zip(self.recordings, seeds, strict=True)]

    def _by_rest(
        self, model: Model, clean: Sequence[Recording], drawn: Sequence[Recording], seeds: Sequence[int]
    ) -> NoiseModel:
        """The levels of noise; where no speed was logged, as the model's rest tells them."""
        if np.isfinite(self.noise.levels.velocity_std).any():
            return self.noise

        def moved(noise: NoiseModel) -> list[np.ndarray]:
            made = simulate(self._drawn(model, noise, seeds))
            return [run.position - still.position for run, still in zip(made, clean, strict=True)]

        reads = reads_unlogged_speed(model, self.recordings)
        return noise_by_rest(self.noise, self.recordings, clean, drawn, moved if reads else None)

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """Return the simulated motion, corrected by the measurement."""
        r, levels = self.recordings[index], self.noise.levels
        to_actuator = prepare(r, plant.model).to_actuator
        usable = run if np.isfinite(run.position).all() else None
        track = smooth_track(r, usable, to_actuator, levels.position_std, levels.velocity_std)
        return motion_of(track, r, plant, to_actuator)

    def loop(self, plant: Plant, index: int, motion: Motion) -> Loop:
        """Return the closed loop, linearised about the motion."""
        track = Track(motion.position, motion.velocity, motion.acceleration)
        return linearise(plant, prepare(self.recordings[index], plant.model), track, motion.gain)

    def propagate(
        self, loops: Sequence[Loop], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the responses to small disturbances, propagated through the sampled loops."""
        return propagate(loops, disturbances)
