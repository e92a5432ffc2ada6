"""The sensors of W runs: the motion that is made, and what the log and the controllers read of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.effects import Plant, SensorErrors

from .experiment import Experiment


class Sensors:
    """Motion and readings of all runs over K substeps; runs are sorted longest first.

    Attributes:
        position, velocity: true motion of the drives, (W, K + 1, n), actuator coordinates; NaN ahead.
        true_start: position and rate of the serial joints at which readings are as the experiments want
            them at the start, (W, 2, n).
    """

    def __init__(self, plants: Sequence[Plant], experiments: Sequence[Experiment]) -> None:
        count, n, substeps = len(plants), plants[0].model.size, experiments[0].substeps
        self.position = np.full((count, substeps + 1, n), np.nan)
        self.velocity = np.full((count, substeps + 1, n), np.nan)
        wanted = np.stack([e.start for e in experiments])
        transmissions = [p.model.transmission for p in plants]
        start = np.stack([s @ j.T for s, j in zip(wanted, transmissions, strict=True)])
        chains = [p.chain.sensors for p in plants]
        self.honest = all(c.none for c in chains)
        self.true_start = wanted
        if self.honest:
            self.position[:, 0], self.velocity[:, 0] = start[:, 0], start[:, 1]
            return
        # a neutral sensor passes values on to the last bit, so that runs may be mixed
        self.errors = SensorErrors.stack(chains)
        true = np.stack([true_motion(c, *s) for c, s in zip(chains, start, strict=True)])
        self.position[:, 0], self.velocity[:, 0] = true[:, 0], true[:, 1]
        self.true_start = np.stack([t @ np.linalg.inv(j).T for t, j in zip(true, transmissions, strict=True)])
        steps = np.array([e.step for e in experiments])
        self.step = steps[:, None, None]
        self.late = np.array([c.delay_s for c in chains]) / steps
        # readings without the delay: position, its rate, and the rate behind its lag
        self.now = np.full((3, *self.position.shape), np.nan)
        self.now[:, :, 0] = start[:, 0], start[:, 1], start[:, 1]

    def read(self, at: int, active: int) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity that the first `active` runs read at substep `at`, (active, n) each."""
        if self.honest:
            return self.position[:active, at], self.velocity[:active, at]
        runs = np.arange(active)
        return self._delayed(runs, np.full(active, at))

    def record(self, first: int, last: int, position: np.ndarray, velocity: np.ndarray) -> None:
        """Take in the motion of substeps `first` + 1 to `last`, (active, c, n) each."""
        active, new = len(position), slice(first + 1, last + 1)
        self.position[:active, new], self.velocity[:active, new] = position, velocity
        if self.honest:
            return
        e = self.errors.first(active)
        seen, rate = reading(e, position, velocity)
        self.now[0, :active, new], self.now[1, :active, new] = seen, rate
        h, lagged = self.step[:active, 0], self.now[2]
        lag = e.lag[:, 0]
        safe = np.where(lag > 0, lag, 1.0)
        kept = np.where(lag > 0, np.exp(-h / safe), 0.0)
        before = self.now[1, :active, first]
        for k in range(position.shape[1]):
            # exact for a rate that changes linearly within a step
            behind = (rate[:, k] - before) / h * lag
            settled = lagged[:active, first + k] - before + behind
            lagged[:active, first + k + 1] = rate[:, k] - behind + kept * settled
            before = rate[:, k]

    def log(self, run: int, rows: slice) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity (N, n) that the log of a run shows at the substeps `rows`."""
        if self.honest:
            return self.position[run, rows], self.velocity[run, rows]
        at = np.arange(self.position.shape[1])[rows]
        return self._delayed(np.full(len(at), run), at)

    def _delayed(self, runs: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Readings of `runs` at substeps `at`, late by each run's delay, before the start as at the start."""
        when = np.maximum(at - self.late[runs], 0.0)
        left = np.minimum(np.floor(when + 1e-9).astype(int), np.maximum(at - 1, 0))
        part = np.where(when - left > 1e-9, when - left, 0.0)[:, None]
        right = np.where(part[:, 0] > 0, left + 1, left)
        h = self.step[runs, 0]
        (q0, v0, w0), (q1, v1, w1) = self.now[:, runs, left], self.now[:, runs, right]
        # cubic between two substeps, by the rates at both
        rest = 1.0 - part
        position = (
            q0 * rest**2 * (1 + 2 * part)
            + q1 * part**2 * (1 + 2 * rest)
            + h * part * rest * (v0 * rest - v1 * part)
        )
        inside = part > 0
        return np.where(inside, position, q0), np.where(inside, w0 * rest + w1 * part, w0)


def reading(
    errors: SensorErrors, position: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Position and its rate as sensors see them, without lag and delay; arrays broadcast over axes."""
    sine, cosine = np.sin(position), np.cos(position)
    slope = errors.scale + errors.sine * cosine - errors.cosine * sine
    seen = errors.scale * position + errors.sine * sine + errors.cosine * cosine + errors.offset
    return seen, slope * velocity


def true_motion(
    errors: SensorErrors, position: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The motion whose `reading` is this; lag and delay are left aside."""
    true = (position - errors.offset) / errors.scale
    for _ in range(20):
        seen, slope = reading(errors, true, np.ones_like(true))
        true = true - (seen - position) / slope
    _, slope = reading(errors, true, np.ones_like(true))
    return true, velocity / slope
