"""The torque that the model needs for a motion, compared with the measured torque."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from workbench.core import InverseDynamics, Recording
from workbench.effects import Plant, compile_plant
from workbench.models import Model
from workbench.recordings import NoiseLevels
from workbench.simulation import Track, edge_rows, motion_of, required_torque, scored_torque, smooth_track

_ORDER = 4
_BAND = 50.0  # Hz: what machines move with, unless an excitation says more


def cutoff_hz(recording: Recording) -> float:
    """Return the cutoff [Hz] below which torques are compared: 50 Hz or the excited band, at most a fifth of
    the row rate.
    """
    return min(max(_BAND, recording.excitation.f_max_hz or 0.0), 0.2 / recording.period)


def inverse_dynamics(
    model: Model, recordings: Sequence[Recording], prior: Sequence[Recording], levels: NoiseLevels
) -> InverseDynamics | None:
    """Return the relative torque error of the model along the measured motions; None where torque is
    missing.
    """
    used = [(r, p) for r, p in zip(recordings, prior, strict=True) if scored_torque(r) is not None]
    if not used or not model.size:
        return None
    plant = compile_plant(model)
    sums = np.sum([torque_sums(plant, r, p, levels) for r, p in used], axis=0)
    return inverse_of(sums, used[0][0])


def torque_sums(
    plant: Plant, recording: Recording, simulated: Recording | None, levels: NoiseLevels
) -> np.ndarray:
    """Return sums of squares over the counted rows, (2, n): measured minus required torque, and measured
    torque.
    """
    measured, needed, valid = torque_pair(plant, recording, simulated, levels)
    return np.stack([np.sum(x[valid] ** 2, axis=0) for x in (measured - needed, measured)])


def inverse_of(sums: np.ndarray, recording: Recording) -> InverseDynamics | None:
    """Return the relative error from `torque_sums` (2, n) of recordings like this one; None if no drive gave
    torque.
    """
    top, bottom = sums
    if not bottom.sum() > 0.0:
        return None
    name = f"zero-phase Butterworth, order {_ORDER}, {cutoff_hz(recording):g} Hz, on both torques"
    with np.errstate(invalid="ignore", divide="ignore"):
        axes = np.sqrt(top / bottom)
    return InverseDynamics(float(np.sqrt(top.sum() / bottom.sum())), axes, name)


def torque_pair(
    plant: Plant, recording: Recording, simulated: Recording | None, levels: NoiseLevels
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return measured and required torque at the point of measurement, with the same filter, (N, n) each,
    and the counted rows.

    Torques are in actuator coordinates. The torque of a row is the mean of what acts just before and
    just after it, since the drive holds it from tick to tick.
    """
    model = plant.model
    to_actuator = recording.to_actuator(model.transmission)
    track = smooth_track(recording, simulated, to_actuator, levels.position_std, levels.velocity_std)
    tap = torque_at_tap(plant, recording, track, to_actuator)
    needed = required_torque(plant, track, recording.period)
    measured, needed = lowpass(tap, recording), lowpass(needed, recording)
    edge = edge_rows(len(tap), recording.period)
    valid = recording.valid.copy()
    valid[:edge], valid[len(valid) - edge :] = False, False
    return measured, needed, valid


def torque_at_tap(plant: Plant, recording: Recording, track: Track, to_actuator: np.ndarray) -> np.ndarray:
    """Return the measured torque (N, n), or the command delayed as in the model; actuator coordinates.

    That of a row is the mean of what acts just before and just after it.
    """
    name = scored_torque(recording)
    assert name is not None
    tap = recording.signals[name] @ np.linalg.inv(to_actuator)
    if name == "torque_command":
        tap = motion_of(track, recording, plant, to_actuator).torque
    return 0.5 * (tap + np.vstack([tap[:1], tap[:-1]]))


def lowpass(values: np.ndarray, recording: Recording, corner_hz: float | None = None) -> np.ndarray:
    """Return the zero-phase low-pass of a signal, at `cutoff_hz` if no corner is given."""
    sos = scipy.signal.butter(
        _ORDER, corner_hz or cutoff_hz(recording), fs=1.0 / recording.period, output="sos"
    )
    return scipy.signal.sosfiltfilt(sos, values, axis=0, padlen=min(len(values) - 1, 3 * 10))
