"""The sensors of one run: what log and controller read of the true motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workbench.core.compiled import compiled
from workbench.effects import Plant, SensorErrors

from .experiment import Experiment


class Sensors(NamedTuple):
    """Errors between motion and reading, as numbers; arrays (n,).

    Attributes:
        honest: whether readings are the motion; nothing else counts then.
        offset, scale, sine, cosine: of the encoder.
        lag: of the rate, over the substep; 0 for none.
        late: delay in substeps; `step` [s].
        seen: (3, K + 1, n), readings without the delay: position, its rate, and the rate behind its lag.
    """

    honest: bool
    offset: np.ndarray
    scale: np.ndarray
    sine: np.ndarray
    cosine: np.ndarray
    lag: np.ndarray
    late: float
    step: float
    seen: np.ndarray


def sensors_of(e: Experiment, plant: Plant) -> tuple[Sensors, np.ndarray]:
    """Return a plant's sensors in an experiment, and the drives' true motion at its start, (2, n)."""
    errors: SensorErrors = plant.chain.sensors
    start = e.start @ plant.model.transmission.T
    honest = errors.none
    n = len(start[0])
    seen = np.full((3, 0 if honest else e.substeps + 1, n), np.nan)
    true = start
    if not honest:
        # what the log shows first is where the run starts; the truth differs by the sensors' errors
        true = np.stack(true_motion(errors, *start))
        seen[:, 0] = start[0], start[1], start[1]
    sensors = Sensors(
        honest=honest,
        offset=np.array(errors.offset, float),
        scale=np.array(errors.scale, float),
        sine=np.array(errors.sine, float),
        cosine=np.array(errors.cosine, float),
        lag=errors.lag / e.step,
        late=errors.delay_s / e.step,
        step=e.step,
        seen=seen,
    )
    return sensors, true


def reading(
    errors: SensorErrors, position: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return position and rate as sensors show them, without lag and delay; arrays broadcast over axes."""
    sine, cosine = np.sin(position), np.cos(position)
    slope = errors.scale + errors.sine * cosine - errors.cosine * sine
    seen = errors.scale * position + errors.sine * sine + errors.cosine * cosine + errors.offset
    return seen, slope * velocity


def true_motion(
    errors: SensorErrors, position: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the motion of which this is the `reading`; lag and delay are ignored."""
    true = (position - errors.offset) / errors.scale
    for _ in range(20):
        seen, slope = reading(errors, true, np.ones_like(true))
        true = true - (seen - position) / slope
    _, slope = reading(errors, true, np.ones_like(true))
    return true, velocity / slope


@compiled()
def record(s: Sensors, k: int, position: np.ndarray, velocity: np.ndarray) -> None:
    """Store the motion at substep `k` (above 0), (n,) each."""
    if s.honest:
        return
    seen = s.seen
    for i in range(len(position)):
        sine, cosine = np.sin(position[i]), np.cos(position[i])
        slope = s.scale[i] + s.sine[i] * cosine - s.cosine[i] * sine
        rate, before = slope * velocity[i], seen[1, k - 1, i]
        seen[0, k, i] = s.scale[i] * position[i] + s.sine[i] * sine + s.cosine[i] * cosine + s.offset[i]
        seen[1, k, i] = seen[2, k, i] = rate
        if s.lag[i] > 0.0:
            # exact for a rate that changes linearly within a step
            behind = (rate - before) * s.lag[i]
            kept = np.exp(-1.0 / s.lag[i])
            seen[2, k, i] = rate - behind + kept * (seen[2, k - 1, i] - before + behind)


@compiled()
def read(s: Sensors, k: int, position: np.ndarray, velocity: np.ndarray) -> None:
    """Replace the motion at substep `k`, (n,) each, by its reading, in place."""
    if s.honest:
        return
    when = max(k - s.late, 0.0)
    left = min(int(np.floor(when + 1e-9)), max(k - 1, 0))
    part = when - left if when - left > 1e-9 else 0.0
    right = left + 1 if part > 0.0 else left
    rest, seen = 1.0 - part, s.seen
    for i in range(len(position)):
        q0, q1 = seen[0, left, i], seen[0, right, i]
        v0, v1 = seen[1, left, i], seen[1, right, i]
        w0, w1 = seen[2, left, i], seen[2, right, i]
        position[i], velocity[i] = q0, w0
        if part > 0.0:
            # cubic between two substeps, by the rates at both
            slopes = s.step * part * rest * (v0 * rest - v1 * part)
            position[i] = q0 * rest**2 * (1 + 2 * part) + q1 * part**2 * (1 + 2 * rest) + slopes
            velocity[i] = w0 * rest + w1 * part


@compiled()
def logged(s: Sensors, stride: int, position: np.ndarray, velocity: np.ndarray) -> None:
    """Replace the motion at every `stride`-th substep, (N, n) each, by what the log shows, in place."""
    for row in range(len(position)):
        read(s, row * stride, position[row], velocity[row])
