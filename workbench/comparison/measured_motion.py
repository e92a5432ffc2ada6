"""One recording along its measured motion: the torque that a model needs for it."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field, replace
from hashlib import sha256

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from workbench.core import Recording
from workbench.effects import Motion, Plant, SensorErrors, giving_way
from workbench.recordings import NoiseLevels
from workbench.simulation import (
    Track,
    motion_of,
    required_torque,
    rigid_torque,
    scored_torque,
    smooth_track,
    true_motion,
)

from .free_start import LEAST_GAIN, FreeStart
from .inverse import lowpass, torque_at_tap

# A log may show the torque that stands until the next row, or that of the row's time, which says no log: the
# mean over what stands comes half a row after the other, and ticks inside a row blur both.
_EARLY, _LATE = -0.6, 0.15  # rows
_BLUR = 0.1  # between 1/12 and 1/8
_SLACK = 0.004  # of a torque's root mean square
_KEPT = 4_000_000  # numbers of rigid torques that are remembered: most candidates share them


@dataclass(frozen=True, eq=False)
class Lateness:
    """Measured minus needed torque, filtered, as a torque that is logged late.

    Attributes:
        rest: the difference, (N, n).
        late: what a delay of the torque by one row removes of it, (N, n).
        shift: by how many rows each torque is late, if that is all of the difference, (n,).
    """

    rest: np.ndarray
    late: np.ndarray
    shift: np.ndarray

    @property
    def is_in_time(self) -> np.ndarray:
        """Return of which torques (n,) the shift is one that a log may have."""
        return self.shift == nearest_in_time(self.shift)


@dataclass(frozen=True)
class FilteredRecording:
    """Motion and torque of a recording, prepared for any model.

    Attributes:
        recording: loop unknown.
        track: smoothed motion of the drives as the sensors show it, actuator coordinates.
        to_actuator: (n, n), positions of the recording to actuator coordinates.
        name: the torque that is compared.
        counts: rows and axes (N, n) that do.
        corner_hz: of the filter on both torques.
    """

    recording: Recording
    track: Track
    to_actuator: np.ndarray
    name: str
    corner_hz: float
    counts: np.ndarray
    _rigid: dict[bytes, np.ndarray] = field(default_factory=dict, init=False, compare=False, repr=False)

    def run(self, plant: Plant | None) -> Recording:
        """Return the recording with the torque that a model needs; NaN without a model."""
        r = self.recording
        rest = np.nan if plant is None else self.residual(plant)
        back = np.linalg.inv(self.to_actuator).T
        torque = r.signals[self.name] - rest
        signals = {"position": r.position, "velocity": self.track.velocity @ back, "torque_command": torque}
        return replace(r, signals={**signals, self.name: torque}, extra={}, derived=(), notes=(), source=None)

    def residual(self, plant: Plant) -> np.ndarray:
        """Return measured minus required torque after the filter, (N, n); zero on rows left out."""
        lateness = self.lateness(plant)
        shift = nearest_in_time(lateness.shift)
        return np.where(self.counts, lateness.rest - shift * lateness.late, 0.0)

    def slack(self, generator: np.random.Generator) -> np.ndarray:
        """Return a random draw (N, n) of the error that differentiation and filtering cause without noise."""
        torque = self.recording.signals[self.name]
        white = lowpass(generator.standard_normal(torque.shape), self.recording, self.corner_hz)
        size = _SLACK * np.sqrt(np.mean(torque**2, axis=0)) / np.sqrt(np.mean(white**2, axis=0))
        return np.where(self.counts, size * white, 0.0)

    def free_start(self, plant: Plant) -> FreeStart:
        """Return what unknown initial states of springs may contribute, in own coordinates."""

        def passed(torque: np.ndarray) -> np.ndarray:
            own = np.einsum("kjs,ji->kis", torque, self.to_actuator)
            return lowpass(own, self.recording, self.corner_hz)

        motion = self.motion(plant) if giving_way(plant.model) else None
        size = np.sqrt(np.mean(self.recording.signals[self.name] ** 2, axis=0))
        return FreeStart.of(plant.model, motion, passed, self.counts, size)

    def lateness(self, plant: Plant) -> Lateness:
        """Return measured minus needed torque, and how it looks late; less `free_start` of it."""
        track, r = self._made(plant), self.recording
        rigid = self.rigid(plant) if plant.chain.sensors.none else None
        tap = _unblurred(torque_at_tap(plant, self.recording, track, self.to_actuator))
        needed = required_torque(plant, track, r.period, rigid) - self._spared(plant, track)
        rest = (tap - needed) @ self.to_actuator
        late = np.gradient(tap @ self.to_actuator, axis=0)
        rest, late = lowpass(rest, r, self.corner_hz), lowpass(late, r, self.corner_hz)
        start = self.free_start(plant)
        rest, late = start.without(rest), start.without(late)
        counted = np.where(self.counts, late, 0.0)
        shift = np.sum(rest * counted, axis=0) / np.maximum(np.sum(counted**2, axis=0), 1e-300)
        return Lateness(rest, late, shift)

    def _spared(self, plant: Plant, track: Track) -> np.ndarray:
        """What motors need not give (N, n) as what hangs on them through springs and gaps does not follow."""
        model = plant.model
        soft = giving_way(model)
        if not soft:
            return np.zeros_like(track.position)
        motion = motion_of(track, self.recording, plant, self.to_actuator)
        total = np.zeros_like(track.position)
        for effect, place, shape in soft:
            offset = effect.response(motion, model, place, shape).offset
            assert offset is not None
            total += offset
        return total / np.maximum(motion.gain, LEAST_GAIN)

    def motion(self, plant: Plant) -> Motion:
        """Return the motion with everything that effects need to know."""
        return motion_of(self._made(plant), self.recording, plant, self.to_actuator)

    def _made(self, plant: Plant) -> Track:
        sensors = plant.chain.sensors
        return self.track if sensors.none else true_track(self.track, sensors, self.recording.period)

    def rigid(self, plant: Plant) -> np.ndarray:
        """Return the `rigid_torque` of the track as the sensors show it; cached."""
        key = _fingerprint(plant.mujoco) + (_fingerprint(plant.links) if plant.bare is not None else b"")
        if key not in self._rigid:
            while len(self._rigid) > _KEPT // self.track.position.size:
                self._rigid.pop(next(iter(self._rigid)))
            self._rigid[key] = rigid_torque(plant, self.track)
        return self._rigid[key]


def nearest_in_time(shift: np.ndarray) -> np.ndarray:
    """Return the nearest shift [rows] by which a log may show torques late: those at a row, or those until
    the next one.
    """
    return np.clip(shift, _EARLY, _LATE)


def _unblurred(tap: np.ndarray) -> np.ndarray:
    """A torque (N, n) that is the mean of two rows, with what the mean takes of fast changes put back.

    With x = omega step / 2, positions at the rows under a torque that is held show an acceleration of
    (x / sin x)^2 times that mean, and under a smooth one 1 / cos x times: 1 + x^2 / 3 or 1 + x^2 / 2.
    """
    long = np.pad(tap, ((1, 1), (0, 0)), mode="edge")
    return tap - _BLUR * np.diff(long, 2, axis=0)


def read_motion(
    recording: Recording, transmission: np.ndarray, levels: NoiseLevels, corner_hz: float
) -> FilteredRecording:
    """Return the smoothed motion of a recording; all rows count.

    Acceleration is kept whole inside the filter's band: what looks like noise there moved the machine too.
    """
    to_actuator = recording.to_actuator(transmission)
    track = smooth_track(
        recording, None, to_actuator, levels.position_std, levels.velocity_std, 1.5 * corner_hz
    )
    name = scored_torque(recording)
    assert name is not None
    whole = np.ones_like(track.position, bool)
    return FilteredRecording(recording, track, to_actuator, name, corner_hz, whole)


def true_track(track: Track, errors: SensorErrors, period: float) -> Track:
    """Return the motion behind the readings of position sensors, with their delay removed."""
    q, w = true_motion(errors, track.position, track.velocity)
    slope = errors.scale + errors.sine * np.cos(q) - errors.cosine * np.sin(q)
    bend = -errors.sine * np.sin(q) - errors.cosine * np.cos(q)
    a = (track.acceleration - bend * w**2) / slope
    if errors.delay_s > 0:
        time = period * np.arange(len(q))
        then = np.minimum(time + errors.delay_s, time[-1])
        q, w, a = (CubicSpline(time, x)(then) for x in (q, w, a))
    return Track(q, w, a)


def _fingerprint(m: mujoco.MjModel) -> bytes:
    """All that a compiled model is, except for its dry friction."""
    bare = copy.copy(m)
    bare.tendon_frictionloss[:], bare.dof_frictionloss[:] = 0.0, 0.0
    raw = np.zeros(mujoco.mj_sizeModel(bare), np.uint8)
    mujoco.mj_saveModel(bare, None, raw)
    return sha256(raw.tobytes()).digest()
