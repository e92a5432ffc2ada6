"""The sampled loop: sensors, their noise, and the control law at each tick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from workbench.core import Controller
from workbench.effects import Plant, TorqueChain

from .experiment import Experiment, differentiates


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
        """Standard normal numbers (3, rows, n), the same at every call."""
        if rows not in self._draws:
            shape = (3, rows, len(self.resolution))
            self._draws[rows] = np.random.default_rng(self.seed).standard_normal(shape)
        return self._draws[rows]

    def logged(
        self, position: np.ndarray, velocity: np.ndarray, torque: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Whole tracks (N, n) as the log shows them."""
        draw = self.draws(len(position))
        return (
            self.read_position(position, draw[0]),
            velocity + self.velocity_std * draw[1],
            torque + self.torque_std * draw[2],
        )

    def read_position(self, position: np.ndarray, draw: np.ndarray) -> np.ndarray:
        """Noise first, then the encoder's rounding."""
        noisy = position + self.position_std * draw
        safe = np.where(self.resolution > 0, self.resolution, 1.0)
        return np.where(self.resolution > 0, np.round(noisy / safe) * safe, noisy)


class Controllers:
    """The control laws of W runs, evaluated together at a tick; arrays are (W, n)."""

    def __init__(
        self,
        size: int,
        experiments: Sequence[Experiment],
        noises: Sequence[SensorNoise | None],
        plants: Sequence[Plant],
    ) -> None:
        self.experiments = experiments
        count, eye = len(experiments), np.eye(size)
        rows = max(len(e.recording) for e in experiments)
        substeps = max(e.substeps for e in experiments)
        self.stride = np.array([e.stride for e in experiments])
        self.kp, self.kd, self.output = (np.zeros((count, size)) for _ in range(3))
        self.limit = np.full((count, size), np.inf)
        self.read = np.zeros((count, size, size))  # actuator to recording coordinates
        self.sense = np.zeros((count, size, size))  # recording to controller coordinates
        self.drive = np.zeros((count, size, size))  # controller torque to actuator torque
        self.reference, self.rate, self.constant = (np.zeros((count, rows, size)) for _ in range(3))
        self.per_row = np.zeros(count, bool)
        self.is_tick = np.zeros((count, substeps + 1), bool)
        self.noise = np.zeros((count, 2, rows, size)) if any(noises) else None
        self.resolution = np.zeros((count, size))
        for i, (e, noise, plant) in enumerate(zip(experiments, noises, plants, strict=True)):
            self._fill(i, e, noise, plant, eye)
        self.feedback = np.zeros((count, size))
        # a loop without a velocity sensor differentiates its encoder from tick to tick
        self.differentiates = np.array([differentiates(e) for e in experiments])[:, None]
        self.period = np.array([e.controller.period_s or e.recording.period for e in experiments])[:, None]
        start = np.stack([e.start @ p.model.transmission.T for e, p in zip(experiments, plants, strict=True)])
        before = np.einsum("wij,wj->wi", self.read, start[:, 0] - self.period * start[:, 1])
        self.last_read = before

    def _fill(self, i: int, e: Experiment, noise: SensorNoise | None, plant: Plant, eye: np.ndarray) -> None:
        rows, back = len(e.recording), np.linalg.inv(plant.model.transmission)
        c = true_controller(e.controller, plant.chain)
        self.is_tick[i, e.ticks] = True
        self.read[i] = np.linalg.inv(e.to_actuator)
        self.sense[i] = (back if c.coordinates == "joint" else eye) @ e.to_actuator
        self.drive[i] = back.T if c.coordinates == "joint" else eye
        self.reference[i, :rows], self.rate[i, :rows] = e.reference, e.reference_rate
        self.constant[i, :rows] = e.feedforward if e.replayed is None else e.replayed
        self.per_row[i] = e.replayed is not None or not e.recording.timing.feedforward_held
        if c.kind == "pd":
            self.kp[i], self.kd[i], self.output[i] = c.kp, c.kd, 1.0
        elif c.kind == "cascade_pv":
            self.kp[i], self.kd[i] = np.multiply(c.kv, c.kp), c.kv
            self.output[i] = c.gain
            self.limit[i] = c.limit if c.limit else np.inf
        if noise is not None and self.noise is not None:
            draw = noise.draws(rows)
            self.noise[i, 0, :rows] = noise.position_std * draw[0]
            self.noise[i, 1, :rows] = noise.velocity_std * draw[1]
            self.resolution[i] = noise.resolution

    def sample(
        self, first: int, last: int, active: int, position: np.ndarray, velocity: np.ndarray
    ) -> np.ndarray:
        """Torque command (active, last - first + 1, n) from substep `first` on, actuator coordinates.

        Args:
            first, last: the chunk of substeps; no controller ticks inside it.
            active: the first `active` runs take part.
            position, velocity: what the sensors say at `first`, actuator coordinates, (active, n).
        """
        a = slice(0, active)
        index = np.arange(active)
        if self.is_tick[a, first].any():
            self._tick(first, a, index, position, velocity)
        out = np.repeat(self.feedback[a][:, None], last - first + 1, axis=1)
        if self.per_row[a].any():
            rows = np.arange(first, last + 1)[None, :] // self.stride[a][:, None]
            out += np.where(self.per_row[a, None, None], self.constant[index[:, None], rows], 0.0)
        return out

    def _tick(
        self, first: int, a: slice, index: np.ndarray, position: np.ndarray, velocity: np.ndarray
    ) -> None:
        """New feedback of the runs whose controllers sample at substep `first`."""
        row = first // self.stride[a]
        y = np.einsum("wij,wj->wi", self.read[a], position)
        v = np.einsum("wij,wj->wi", self.read[a], velocity)
        if self.noise is not None:
            y, v = y + self.noise[index, 0, row], v + self.noise[index, 1, row]
            safe = np.where(self.resolution[a] > 0, self.resolution[a], 1.0)
            y = np.where(self.resolution[a] > 0, np.round(y / safe) * safe, y)
        tick = self.is_tick[a, first][:, None]
        v = np.where(self.differentiates[a], (y - self.last_read[a]) / self.period[a], v)
        self.last_read[a] = np.where(tick, y, self.last_read[a])
        z = np.einsum("wij,wj->wi", self.sense[a], y)
        zv = np.einsum("wij,wj->wi", self.sense[a], v)
        raw = self.kp[a] * (self.reference[index, row] - z) + self.kd[a] * (self.rate[index, row] - zv)
        law = self.output[a] * np.clip(raw, -self.limit[a], self.limit[a])
        fresh = np.einsum("wij,wj->wi", self.drive[a], law)
        fresh += np.where(self.per_row[a, None], 0.0, self.constant[index, row])
        self.feedback[a] = np.where(tick, fresh, self.feedback[a])


def true_controller(stated: Controller, chain: TorqueChain) -> Controller:
    """A loop with the gains that it really has: on the position error kp, on the speed kd or kv."""
    position, rate = chain.kp_scale, chain.kd_scale
    if stated.kind == "none" or stated.kind == "unknown" or bool(np.all([position == 1.0, rate == 1.0])):
        return stated

    def scaled(values: tuple[float, ...], by: np.ndarray) -> tuple[float, ...]:
        return tuple(map(float, np.multiply(values, by))) if values else values

    return replace(
        stated, kp=scaled(stated.kp, position), kd=scaled(stated.kd, rate), kv=scaled(stated.kv, rate)
    )
