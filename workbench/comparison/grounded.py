"""Recordings on the ground, replayed in short windows from measured states under the torque that was logged.

Positions are scored, and what the ground's force is to the drives: measured and simulated force alike go
through the transposed Jacobian of the foot along the measured motion, so that every axis has its share [N m].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.effects import Effect, Motion, OnGround, Plant, effect_named, kinds
from workbench.models import Model
from workbench.recordings import white_noise
from workbench.simulation import (
    GROUND_TORQUE,
    Disturbance,
    Tangents,
    as_made,
    motion_of,
    on_all_cores,
    scored_torque,
    smooth_track,
    steps_of,
)

from .feet import Feet
from .floating import floats
from .noise import DRAWS, NoiseModel, noise_seeds
from .replay import Replay
from .simulated import Simulated
from .standing import FORCE, Standing, check_ground, on_ground, stand, tap_torque, without_ground
from .starts import local_state, shaken


class ContactWindows(Replay[tuple[Standing, Tangents]]):
    """A replay in which every model runs on its ground in short windows."""

    machine_alone: ClassVar[bool] = False
    smooth: ClassVar[bool] = False
    each: ClassVar[tuple[str, ...]] = ("_standing",)

    def __init__(self, model: Model, recordings: Sequence[Recording], noise: NoiseModel) -> None:
        for r in recordings:
            if on_ground(r):
                check_ground(model, r)
        self.noise = noise
        self._first, self._steps = recordings[0], steps_of(recordings[0], model)
        plant = self._on_ground(model)
        told = [white_noise(f, r.valid) for r in recordings if FORCE in r.extra for f in r.extra[FORCE].T]
        known = [x for x in told if np.isfinite(x)]
        self._force_noise = float(np.median(known)) if known else 0.0
        self._standing = tuple(
            stand(r, plant, noise.levels, self._steps.per_row, self._force_noise) for r in recordings
        )
        self.recordings = tuple(s.recording for s in self._standing)

    def shows(self, effect: str) -> bool:
        """Return whether it can show an effect: all except those with a state that no sensor shows at the
        start of a window.
        """
        return not kinds.has_hidden_state(effect_named(effect))

    def needs_runs(self, effect: Effect) -> bool:
        """Return whether an effect has to be simulated: contacts and the penetration of a foot are no torque
        along a motion.
        """
        return isinstance(effect, OnGround) or kinds.changes_foot_position(effect)

    def like(self, model: Model, recordings: Sequence[Recording]) -> ContactWindows:
        """Return the same replay for other recordings."""
        return ContactWindows(model, recordings, self.noise)

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Return the runs of all models in all windows."""
        standing = self._standing[:first]
        plants = [self._compiled(m) for m in models]
        pairs = [(s, p) for p in plants for s in standing]
        made = on_all_cores(lambda pair: pair[0].run(pair[1]), pairs)
        return [tuple(made[k * len(standing) : (k + 1) * len(standing)]) for k in range(len(models))]

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Return runs of one model without and with noise of position, velocity and torque in starts and
        windows; noise of the force is added.

        Raises:
            SimulationError: a model that no body can be, or that flies apart in the windows.
        """
        plant = self._on_ground(model)
        clean = on_all_cores(lambda s: s.run(plant), self._standing)
        for run in clean:
            if not np.isfinite(run.position).all():
                raise SimulationError(
                    f"model '{model.name}' diverges on the ground of '{run.name}': check the position "
                    "of its ground, the size of its feet, and how stiff their contact is"
                )
        smooth = [self._quiet(s) for s in self._standing]
        still = on_all_cores(lambda s: s.run(plant), smooth)
        noisy: list[tuple[Recording, ...]] = []
        for seeds in noise_seeds(len(clean), draws, seed):
            seen = [self._seen(s, n) for s, n in zip(smooth, seeds, strict=True)]
            moved = on_all_cores(lambda s: s.run(plant), seen)
            quiet, shown = ([s.recording for s in standing] for standing in (smooth, seen))
            parts = zip(clean, quiet, still, shown, moved, strict=True)
            noisy.append(tuple(shaken(*each) for each in parts))
        return Simulated(self.recordings, tuple(clean), tuple(noisy), self.noise)

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """Return the measured motion and the motion of the feet, whatever the run.

        Where no plate measured the force on the feet of a base that floats, it is that of the run.
        """
        s, levels = self._standing[index], self.noise.levels
        track = smooth_track(s.recording, None, s.to_actuator, levels.position_std, levels.velocity_std)
        base = motion_of(track, without_ground(s.recording), plant, s.to_actuator)
        standing = self._compiled(plant.model)
        assert standing is not None
        feet = Feet.along(standing, track.position)
        contact, force = None, s.force
        if FORCE not in s.recording.extra and floats(s.recording):
            force = np.nan_to_num(run.extra[FORCE])
        if FORCE in s.recording.extra:
            contact = feet.contact(s.windows.velocity, s.force, self._force_noise, s.velocity_noise)

        def required(other: Model) -> np.ndarray:
            held = feet if other is plant.model else Feet.along(self._on_ground(other), track.position)
            return base.required(other) - held.torque(force) / base.gain

        return replace(base, required=required, contact=contact)

    def loop(self, plant: Plant, index: int, motion: Motion) -> tuple[Standing, Tangents]:
        """Return the input of `propagate`."""
        del motion
        standing = self._standing[index]
        return standing, Tangents(self._on_ground(plant.model), standing.windows)

    def propagate(
        self, loops: Sequence[tuple[Standing, Tangents]], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the responses to small disturbances in all windows, linearised row by row."""
        return on_all_cores(_respond, loops, disturbances)

    def start_responses(self, model: Model, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the starts of the windows, and what position and velocity measured there do."""
        s = self._standing[index]
        tangents, (rows, n) = Tangents(self._on_ground(model), s.windows), s.windows.torque.shape
        readings = np.zeros((2 * n, 2, rows, n))
        for k in range(2 * n):
            readings[k, k // n, :, k % n] = 1.0
        position, force = tangents.travel(np.zeros((2 * n, rows, n)), readings)
        position = position - np.moveaxis(readings[:, 0], 0, -1)  # the sensors go on reading what they read
        return s.windows.starts, np.stack(_compared(s, position, force), axis=1)

    def _on_ground(self, model: Model) -> Plant:
        return self._steps.compiled(as_made(model, self._first), grounded=True)

    def _compiled(self, model: Model) -> Plant | None:
        """None where MuJoCo refuses the model."""
        try:
            return self._on_ground(model)
        except SimulationError:
            return None

    def _quiet(self, s: Standing) -> Standing:
        """The recording as smooth as its states were taken to be."""
        back = np.linalg.inv(s.to_actuator).T
        return self._again(
            s,
            s.recording.with_signals(position=s.windows.position @ back, velocity=s.windows.velocity @ back),
        )

    def _seen(self, smooth: Standing, seed: int) -> Standing:
        """A smooth recording as noisy sensors would have shown it."""
        r, noise = smooth.recording, self.noise.draw(seed)
        torque = scored_torque(without_ground(r))
        assert torque is not None
        generator = np.random.default_rng([seed, 7])
        # a foot that rests shows one line of the encoder: where the truth lies beside it, each window draws
        starts = smooth.windows.starts
        window = np.searchsorted(0.5 * (starts[1:] + starts[:-1]), np.arange(len(r)))
        beside = noise.resolution * generator.uniform(-0.5, 0.5, (len(starts), len(r.axes)))[window]
        q, w, u = noise.logged(r.position + beside, r.velocity, r.signals[torque])
        q = q - beside
        seen = r.with_signals(position=q, velocity=w)
        if torque == "torque_measured":
            seen = seen.with_signals(torque_measured=u)
        if FORCE in r.extra:
            felt = self._force_noise * generator.standard_normal(smooth.force.shape)
            seen = seen.with_signals(**{GROUND_TORQUE: r.signals[GROUND_TORQUE] + smooth.torque(felt)})
            seen = replace(seen, extra={**r.extra, FORCE: r.extra[FORCE] + felt})
        return self._again(smooth, seen)

    def _again(self, s: Standing, recording: Recording) -> Standing:
        """The same windows on another version of the recording."""
        q, w, _ = local_state(recording, self.noise.levels)
        windows = replace(
            s.windows,
            position=q @ s.to_actuator.T,
            velocity=w @ s.to_actuator.T,
            torque=tap_torque(recording, s.to_actuator),
        )
        return replace(s, recording=recording, windows=windows)


def _respond(loop: tuple[Standing, Tangents], disturbance: Disturbance) -> tuple[np.ndarray, np.ndarray]:
    s, tangents = loop
    extra = np.array(disturbance.torque)
    # the torque at the tap was logged, whatever the model says of what is before it
    extra[list(disturbance.taps)] = 0.0
    readings = np.zeros((len(extra), 2, *extra.shape[1:]))
    for column, values in disturbance.readings.items():
        readings[column] = values
    return _compared(s, *tangents.travel(extra, readings))


def _compared(s: Standing, position: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Changes of the drives (N, n, C) and of the ground's force (N, 3 F, C), as recordings have them."""
    position = np.einsum("ij,kjc->kic", np.linalg.inv(s.to_actuator), position)
    each = [s.torque(force[..., c]) for c in range(position.shape[-1])]
    return position, np.stack(each, axis=-1) if each else position
