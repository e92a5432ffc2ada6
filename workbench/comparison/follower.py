"""Changes of the torque that a model needs along a measured motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.effects import Motion, Plant
from workbench.simulation import Disturbance, Track, interpolate, slopes

from .free_start import LEAST_GAIN, FreeStart
from .inverse import lowpass
from .measured_motion import FilteredRecording, Lateness


@dataclass(frozen=True)
class Follower:
    """Changes of the torque that a model needs along one track."""

    reading: FilteredRecording
    plant: Plant
    motion: Motion

    def respond(self, disturbance: Disturbance) -> tuple[np.ndarray, np.ndarray]:
        """Return the change of position (zero) and of the required torque, filtered, (N, n, C) each."""
        torque = np.array(disturbance.torque)
        if self.reading.name == "torque_measured":
            # what lies between command and tap was measured, whatever the model says of it
            torque[list(disturbance.taps)] = 0.0
        for column, part in disturbance.readings.items():
            torque[column] += self._shifted(part[0])
        needed = -np.moveaxis(torque / np.maximum(self.motion.gain, LEAST_GAIN), 0, -1)
        # most columns act on one axis alone
        passed, acts = np.zeros_like(needed), np.any(needed, axis=0)
        passed[:, acts] = lowpass(needed[:, acts], self.reading.recording, self.reading.corner_hz)
        passed = self._free.without(np.einsum("kjc,ji->kic", passed, self.reading.to_actuator))
        return np.zeros_like(passed), self._timed(passed)

    def _timed(self, columns: np.ndarray) -> np.ndarray:
        """Columns (N, n, C), in own coordinates, without what a shift of the torque in time would take up."""
        late = np.where(self.reading.counts & self.lateness.is_in_time, self.lateness.late, 0.0)
        size = np.maximum(np.sum(late**2, axis=0), 1e-300)
        out = np.where(self.reading.counts[:, :, None], columns, 0.0)
        return out - late[:, :, None] * (np.einsum("ki,kic->ic", late, out) / size[:, None])

    @cached_property
    def lateness(self) -> Lateness:
        """Return how the model's residual looks as a torque that is logged late."""
        return self.reading.lateness(self.plant)

    def beyond_time(self) -> tuple[np.ndarray, np.ndarray]:
        """Return measured minus required torque, and what a delay by one row removes of it, (N, n) each.

        Where the whole difference looks like a shift in time that no log has; zero elsewhere.
        """
        there = self.reading.counts & ~self.lateness.is_in_time
        return np.where(there, self.lateness.rest, 0.0), np.where(there, self.lateness.late, 0.0)

    @cached_property
    def _free(self) -> FreeStart:
        return self.reading.free_start(self.plant)

    def _shifted(self, position: np.ndarray) -> np.ndarray:
        """Torque (N, n) that a change of what the encoders read stands for."""
        step = self.reading.recording.period
        back = np.linalg.inv(self.plant.model.transmission)
        rate = np.gradient(position, step, axis=0)
        state = [x @ back.T @ self.plant.lift.T for x in (np.gradient(rate, step, axis=0), rate, position)]
        whole = np.sum([np.einsum("kij,kj->ki", s, x) for s, x in zip(self._slopes, state, strict=True)], 0)
        return whole @ self.plant.lift @ back

    @cached_property
    def _slopes(self) -> list[np.ndarray]:
        m = self.motion
        track = Track(m.position, m.velocity, m.acceleration)
        rows, *parts = slopes(self.plant, track, m.step)
        return [interpolate(rows, p, len(m.position)) for p in parts]
