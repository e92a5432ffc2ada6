"""The sampled loop of one run: sensor noise, and the control law at each tick."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from workbench.core import Controller, Recording
from workbench.core.compiled import compiled
from workbench.effects import Plant, TorqueChain
from workbench.recordings.velocity import derive_velocity

from .experiment import Experiment
from .unlogged_rate import differentiates

_LATE = 0x7A  # of the seed of rows that are late


@dataclass(frozen=True)
class SensorNoise:
    """Noise of the logged signals, in the recording's coordinates; each (n,), zero for none.

    `resolution`: encoder step that positions are rounded to [rad or m]; `position_std`: white noise on
    top, `velocity_std`, `torque_std`: white noise. `seed` fixes the draw.
    """

    resolution: np.ndarray
    position_std: np.ndarray
    velocity_std: np.ndarray
    torque_std: np.ndarray
    seed: int
    _draws: dict[int, np.ndarray] = field(default_factory=dict, compare=False, repr=False)

    def draws(self, rows: int) -> np.ndarray:
        """Return standard normal numbers (3, rows, n); the same at every call."""
        if rows not in self._draws:
            shape = (3, rows, len(self.resolution))
            self._draws[rows] = np.random.default_rng(self.seed).standard_normal(shape)
        return self._draws[rows]

    def of_late_rows(self, recording: Recording) -> np.ndarray:
        """Return the error of position and rate, (2, N, n), that a loop reads from rows that come late."""
        if not recording.late_s:
            return np.zeros((2, *recording.position.shape))
        rate = recording.get("velocity")
        if rate is None:
            rate = derive_velocity(recording.position, recording.period)
        moved = np.stack([rate, np.gradient(rate, recording.period, axis=0)])
        late = np.random.default_rng([self.seed, _LATE]).standard_normal(len(recording))
        return recording.late_s * late[:, None] * moved

    def logged(
        self, position: np.ndarray, velocity: np.ndarray, torque: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return tracks (N, n) as the log shows them."""
        draw = self.draws(len(position))
        return (
            self.read_position(position, draw[0]),
            velocity + self.velocity_std * draw[1],
            torque + self.torque_std * draw[2],
        )

    def read_position(self, position: np.ndarray, draw: np.ndarray) -> np.ndarray:
        """Return positions with noise, then rounded as by the encoder."""
        noisy = position + self.position_std * draw
        safe = np.where(self.resolution > 0, self.resolution, 1.0)
        return np.where(self.resolution > 0, np.round(noisy / safe) * safe, noisy)


class ControlLaw(NamedTuple):
    """A loop as numbers; arrays (n,) unless said otherwise.

    Attributes:
        is_tick: (K + 1,), whether the controller samples at a substep; `number` (K + 1,), how often before.
        stride: substeps in a row.
        kp, kd, output, limit: torque = output * clip(kp * error + kd * rate error, limit).
        read, sense, drive: (n, n), actuator to recording coordinates, these to the controller's, and the
            controller's torque to actuator torque.
        reference, rate: (T, n), at each of T ticks.
        constant: at each tick too, or at each row (N, n); added to the torque, actuator coordinates.
        per_row: whether it follows the rows rather than the ticks.
        noise: (2, N, n) of the readings of position and rate, or (2, 0, n).
        resolution: encoder step, 0 for none.
        differentiates, period: whether the rate is taken from positions at successive ticks [s].
        last_read, feedback: state, changed at each tick.
    """

    is_tick: np.ndarray
    number: np.ndarray
    stride: int
    kp: np.ndarray
    kd: np.ndarray
    output: np.ndarray
    limit: np.ndarray
    read: np.ndarray
    sense: np.ndarray
    drive: np.ndarray
    reference: np.ndarray
    rate: np.ndarray
    constant: np.ndarray
    per_row: bool
    noise: np.ndarray
    resolution: np.ndarray
    differentiates: bool
    period: float
    last_read: np.ndarray
    feedback: np.ndarray


def control_law(e: Experiment, plant: Plant, noise: SensorNoise | None) -> ControlLaw:
    """Return the loop of an experiment on a plant, before its first tick."""
    rows, n = e.reference.shape
    eye, back = np.eye(n), np.linalg.inv(plant.model.transmission)
    c = true_controller(e.controller, plant.chain)
    is_tick = np.zeros(e.substeps + 1, np.bool_)
    is_tick[e.ticks] = True
    kp = kd = output = np.zeros(n)
    limit = np.full(n, np.inf)
    if c.kind == "pd":
        kp, kd, output = np.array(c.kp, float), np.array(c.kd, float), np.ones(n)
    elif c.kind == "cascade_pv":
        kp, kd = np.multiply(c.kv, c.kp), np.array(c.kv, float)
        output = np.array(c.gain, float)
        limit = np.array(c.limit, float) if c.limit else limit
    disturbed, resolution = np.zeros((2, 0, n)), np.zeros(n)
    if noise is not None:
        draw = noise.draws(rows)
        disturbed = np.stack([noise.position_std * draw[0], noise.velocity_std * draw[1]])
        disturbed += noise.of_late_rows(e.recording)
        resolution = np.ascontiguousarray(noise.resolution, float)
    read = np.linalg.inv(e.to_actuator)
    period = e.controller.period_s or e.recording.period
    start = e.start @ plant.model.transmission.T
    constant = e.feedforward if e.replayed is None else e.replayed
    held = e.recording.timing.reference_held
    per_row = e.replayed is not None or not e.recording.timing.feedforward_held
    return ControlLaw(
        is_tick=is_tick,
        number=np.cumsum(is_tick) - is_tick,
        stride=e.stride,
        kp=kp,
        kd=kd,
        output=output,
        limit=limit,
        read=_plain(read),
        sense=_plain((back if c.coordinates == "joint" else eye) @ e.to_actuator),
        drive=_plain(back.T if c.coordinates == "joint" else eye),
        reference=_plain(e.at_ticks(e.reference, held)),
        rate=_plain(e.at_ticks(e.reference_rate, held)),
        constant=_plain(constant if per_row else e.at_ticks(constant)),
        per_row=per_row,
        noise=disturbed,
        resolution=resolution,
        differentiates=differentiates(e),
        period=float(period),
        last_read=read @ (start[0] - period * start[1]),
        feedback=np.zeros(n),
    )


@compiled()
def tick(c: ControlLaw, k: int, position: np.ndarray, velocity: np.ndarray) -> None:
    """Sample at substep `k`: new feedback from what sensors say, actuator coordinates, (n,) each."""
    row, now, n = k // c.stride, c.number[k], len(c.kp)
    y, v = np.zeros(n), np.zeros(n)
    for i in range(n):
        for j in range(n):
            y[i] += c.read[i, j] * position[j]
            v[i] += c.read[i, j] * velocity[j]
        if c.noise.shape[1] > 0:
            y[i] += c.noise[0, row, i]
            v[i] += c.noise[1, row, i]
            if c.resolution[i] > 0.0:
                y[i] = np.round(y[i] / c.resolution[i]) * c.resolution[i]
        if c.differentiates:
            v[i] = (y[i] - c.last_read[i]) / c.period
        c.last_read[i] = y[i]
        c.feedback[i] = 0.0 if c.per_row else c.constant[now, i]
    for i in range(n):
        z, rate = 0.0, 0.0
        for j in range(n):
            z += c.sense[i, j] * y[j]
            rate += c.sense[i, j] * v[j]
        raw = c.kp[i] * (c.reference[now, i] - z) + c.kd[i] * (c.rate[now, i] - rate)
        law = c.output[i] * min(max(raw, -c.limit[i]), c.limit[i])
        for j in range(n):
            c.feedback[j] += c.drive[j, i] * law


def true_controller(stated: Controller, chain: TorqueChain) -> Controller:
    """Return a loop with its real gains: kp acts on the position error, kd or kv on the speed."""
    position, rate = chain.kp_scale, chain.kd_scale
    if stated.kind == "none" or stated.kind == "unknown" or bool(np.all([position == 1.0, rate == 1.0])):
        return stated

    def scaled(values: tuple[float, ...], by: np.ndarray) -> tuple[float, ...]:
        return tuple(map(float, np.multiply(values, by))) if values else values

    return replace(
        stated, kp=scaled(stated.kp, position), kd=scaled(stated.kd, rate), kv=scaled(stated.kv, rate)
    )


def _plain(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, float)
