"""Recordings with unknown loops: every model follows the measured motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar, Self

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.effects import Motion, Plant, compile_plant, giving_way, tendon_leads
from workbench.models import Model, axis_tendon
from workbench.simulation import Disturbance, SensorNoise, as_made

from .band import corner_hz
from .counted_rows import moving
from .follower import Follower
from .inverse import cutoff_hz
from .measured_motion import FilteredRecording, read_motion
from .noise import DRAWS, NoiseModel, noise_seeds
from .replay import Replay
from .simulated import Simulated


def followed(recordings: Sequence[Recording], why: str = "") -> tuple[Recording, ...]:
    """Return the recordings with their loops marked as unknown, whatever loop a model states; a note says
    why.
    """
    return tuple(_along(r, why) for r in recordings)


def _along(recording: Recording, why: str) -> Recording:
    if recording.controller.kind == "none":
        why = "No controller holds the machine, so its simulation drifts"
    note = (f"{why}; instead, the torque along the measured motion is compared.",) if why else ()
    asked = ("position_reference", "velocity_reference")
    return replace(
        recording,
        controller=replace(recording.controller, kind="unknown"),
        signals={name: x for name, x in recording.signals.items() if name not in asked},
        notes=(*recording.notes, *note),
    )


class InverseDynamicsReplay(Replay[Follower]):
    """A replay in which every model follows the measured motion; the torque that it needs is scored.

    The position is taken from the recording, so that it says nothing of the model. Rows at the edges, where
    differentiating errs, and axes while they stand still, where dry friction takes any value, do not count.
    """

    simulates: ClassVar[bool] = False
    each: ClassVar[tuple[str, ...]] = ("_read", "_smooth")

    def __init__(
        self, recordings: tuple[Recording, ...], noise: NoiseModel, model: Model, corner: float | None = None
    ) -> None:
        self.recordings, self.noise, self._transmission = recordings, noise, model.transmission
        plant = self._compiled(model)
        self._corner = corner or min(corner_hz(r, plant, noise.levels) for r in recordings)
        first = [self._reading(r) for r in recordings]
        smooth = [self._reading(_quiet(r)) for r in first]
        again = self._seen(smooth, [noise.draw(k) for k in range(len(smooth))])
        wobbles = [a.track.velocity - s.track.velocity for a, s in zip(again, smooth, strict=True)]
        counts = [
            c & _driven(r)
            for c, r in zip(moving(first, wobbles, self._transmission, _leads(plant)), first, strict=True)
        ]
        self._read, self._smooth = (
            tuple(replace(r, counts=c) for r, c in zip(each, counts, strict=True)) for each in (first, smooth)
        )
        self._drawn: dict[tuple[int, int], list[list[FilteredRecording]]] = {}

    def like(self, model: Model, recordings: Sequence[Recording]) -> InverseDynamicsReplay:
        """Return the same replay, with the same filter, for other recordings of the same kind."""
        return InverseDynamicsReplay(followed(recordings), self.noise, model, self._corner)

    def only(self, chosen: Sequence[int]) -> Self:
        """Return the same replay for some of the recordings."""
        part = super().only(chosen)
        part._drawn = {}
        return part

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Return the recordings with the torque that each model needs instead of the measured torque."""
        plants = [self._tried(m) for m in models]
        plants = [p if p is not None and self._foretold(p) else None for p in plants]
        return [tuple(_run(reading, p) for reading in self._read[:first]) for p in plants]

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Return runs of one model without and with noise of position, velocity and torque, which passes
        through differentiation, model and filter.

        Raises:
            SimulationError: a model that no body can be.
        """
        plant = self._compiled(model)
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
        """Return the measured motion, whatever the run."""
        del run
        return self._read[index].motion(plant)

    def loop(self, plant: Plant, index: int, motion: Motion) -> Follower:
        """Return how a torque along the motion changes the required torque."""
        return Follower(self._read[index], plant, motion)

    def propagate(
        self, loops: Sequence[Follower], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the responses to small disturbances, which pass only through the filter."""
        return [loop.respond(d) for loop, d in zip(loops, disturbances, strict=True)]

    def _compiled(self, model: Model) -> Plant:
        return compile_plant(as_made(model, self.recordings[0]))

    def _tried(self, model: Model) -> Plant | None:
        """None where MuJoCo refuses the model."""
        try:
            return self._compiled(model)
        except SimulationError:
            return None

    def _foretold(self, plant: Plant) -> bool:
        """Whether what gives way in a model says where its links are, rather than the torque it explains."""
        model = plant.model
        soft = giving_way(model)
        motions = [reading.motion(plant) for reading in self._read] if soft else []
        return all(effect.foretells(motions, model, place, shape) for effect, place, shape in soft)

    def _reading(self, recording: Recording) -> FilteredRecording:
        corner = min(self._corner, cutoff_hz(recording))
        return read_motion(recording, self._transmission, self.noise.levels, corner)

    def _seen(
        self, smooth: Sequence[FilteredRecording], noises: Sequence[SensorNoise]
    ) -> list[FilteredRecording]:
        """Smooth readings as noisy sensors would have shown them."""
        seen = [self._reading(_noisy(s.recording, n, s.name)) for s, n in zip(smooth, noises, strict=True)]
        return [replace(r, counts=s.counts) for r, s in zip(seen, smooth, strict=True)]

    def _draws(self, seed: int, draws: int) -> list[list[FilteredRecording]]:
        if (seed, draws) not in self._drawn:
            self._drawn[seed, draws] = [
                self._seen(self._smooth, [self.noise.draw(s) for s in seeds])
                for seeds in noise_seeds(len(self.recordings), draws, seed)
            ]
        return self._drawn[seed, draws]


def _leads(plant: Plant) -> np.ndarray:
    """How long before a reversal dry friction of drives and pins turns [s], (2 n,)."""
    leads, places = tendon_leads(plant.model, plant.mujoco), ("actuator", "joint")
    return np.array([leads.get(axis_tendon(i, of), 0.0) for of in places for i in range(plant.model.size)])


def _driven(reading: FilteredRecording) -> np.ndarray:
    """Axes (n,) that have a drive: a torque that is nil throughout has no noise to hold a rest against."""
    return np.any(reading.recording.signals[reading.name] != 0.0, axis=0)


def _run(reading: FilteredRecording, plant: Plant | None) -> Recording:
    """NaN where links would be where they cannot go, as by an encoder that is far off."""
    try:
        return reading.run(plant)
    except SimulationError:
        return reading.run(None)


def _quiet(reading: FilteredRecording) -> Recording:
    """The recording with its motion as smooth as it was taken to be."""
    back = np.linalg.inv(reading.to_actuator).T
    track = reading.track
    return reading.recording.with_signals(position=track.position @ back, velocity=track.velocity @ back)


def _noisy(smooth: Recording, noise: SensorNoise, name: str) -> Recording:
    """A smooth recording as noisy sensors would have shown it."""
    q, w, torque = noise.logged(smooth.position, smooth.velocity, smooth.signals[name])
    seen = smooth.with_signals(position=q, velocity=w)
    return seen.with_signals(torque_measured=torque) if name == "torque_measured" else seen
