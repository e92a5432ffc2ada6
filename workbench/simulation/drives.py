"""The drives of W runs: from the torque that is asked for to the torque on the shaft."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.effects import Plant, follow, torque_bounds

from .experiment import Experiment


@dataclass(frozen=True)
class Passed:
    """What drives make of a chunk of c substeps, for the first A runs, actuator coordinates.

    Attributes:
        tap: `torque_measured` just after each substep's time, (A, c + 1, n).
        shaft: mean torque on the shafts over each substep, (A, c, n).
        early: what torque edges inside the substeps add to the impulse's moment [N m s^2], (A, n), or None
            where there are none: a mean torque has the right impulse, but an edge also moves the position.
    """

    tap: np.ndarray
    shaft: np.ndarray
    early: np.ndarray | None


class Drives:
    """The torque chains of all runs, in the order of their doors; runs are sorted longest first."""

    def __init__(self, plants: Sequence[Plant], experiments: Sequence[Experiment]) -> None:
        step = self.step_s = experiments[0].step
        pairs = zip(plants, experiments, strict=True)
        # where a loop's log already carries the delay it has been applied all the same, only before the log
        delay = np.array([e.delay(p.chain.delay_s, p.model) for p, e in pairs]) / step
        self.whole = np.floor(delay + 1e-9).astype(int)
        self.fraction = np.where(delay - self.whole > 1e-9, delay - self.whole, 0.0)[:, None, None]
        self.longest_delay = int(self.whole.max()) + 1
        self.limit, self.stall, self.no_load, self.gain, self.bias = (
            np.stack([getattr(p.chain, name) for p in plants])[:, None]
            for name in ("limit", "stall", "no_load", "gain", "bias")
        )
        # torque measured behind the drive has its lag already
        behind = np.array([e.behind == "all" for e in experiments])[:, None]
        self.lag = np.where(behind, 0.0, np.stack([p.chain.lag for p in plants])) / step
        self.heating, heat_time = (
            np.stack([getattr(p.chain, name) for p in plants]) for name in ("heating", "heat_time")
        )
        self.cooling = heat_time / step
        self.current, self.heat = np.zeros_like(self.lag), np.zeros_like(self.lag)
        self.lags, self.heats = bool(self.lag.any()), bool(self.heating.any())
        self.follow_speed = any(p.chain.follows_speed for p in plants)
        pairs = zip(plants, experiments, strict=True)
        self.before = np.stack([p.model.transmission @ e.start[1] for p, e in pairs])

    def pass_on(
        self, command: np.ndarray, first: int, last: int, active: int, pad: int, speed: np.ndarray
    ) -> Passed:
        """Send a chunk of commands through the chain.

        Args:
            command: (W, pad + K + 1, n), zero before the first command.
            first, last: chunk of substeps; one only where a chain follows the speed.
            active: the first `active` runs.
            pad: rows before substep 0.
            speed: of the drives at `first`, (active, n).
        """
        steps = np.arange(first, last + 1)[None, :] - self.whole[:active, None] + pad
        index = np.arange(active)[:, None]
        newer, older = command[index, steps], command[index, steps - 1]
        fraction, limit = self.fraction[:active], self.limit[:active]
        at = np.where(fraction > 0, older, newer)
        if self.follow_speed:
            # a tap shows the torque at one time, a step feels the limits half a step later
            now, middle = speed, 1.5 * speed - 0.5 * self.before[:active]
            self.before[:active] = speed
            tap = np.clip(at, *self._bounds(now, active))
            limits = self._bounds(middle, active)
            newer, older = np.clip(newer, *limits), np.clip(older, *limits)
        else:
            tap = np.clip(at, -limit, limit)
            newer, older = np.clip(newer, -limit, limit), np.clip(older, -limit, limit)
        mean = newer * (1 - fraction) + older * fraction
        edges = older - newer
        if self.lags:
            tap, mean = self._behind_lag(tap, mean, older, newer, active)
            edges = np.where(self.lag[:active, None] > 0, 0.0, edges)
        gain = self.gain[:active]
        if self.heats:
            gain = gain * self._cool_share(mean[:, :-1], active)
        shaft = gain * mean[:, :-1] + self.bias[:active]
        early = None
        if fraction.any():
            share = 0.5 * self.step_s**2 * (fraction * (1.0 - fraction))[:, 0]
            early = share * (gain * edges[:, :-1]).sum(axis=1)
        return Passed(tap, shaft, early)

    def _behind_lag(
        self, tap: np.ndarray, mean: np.ndarray, older: np.ndarray, newer: np.ndarray, active: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Tap and mean torque behind the current loops; the state moves on by all substeps but the last."""
        tap, mean = tap.copy(), mean.copy()
        ratio, fraction = self.lag[:active], self.fraction[:active, 0]
        there, now = ratio > 0, self.current[:active]
        for k in range(tap.shape[1]):
            after, behind = follow(now, older[:, k], newer[:, k], fraction, ratio)
            tap[:, k] = np.where(there, now, tap[:, k])
            mean[:, k] = np.where(there, behind, mean[:, k])
            if k < tap.shape[1] - 1:
                now = after
        self.current[:active] = now
        return tap, mean

    def _cool_share(self, mean: np.ndarray, active: int) -> np.ndarray:
        """What heat leaves of the motors' gain over each substep, (active, c, n)."""
        out, heat = np.empty_like(mean), self.heat[:active]
        none = np.zeros((active, 1))
        for k in range(mean.shape[1]):
            square = mean[:, k] ** 2
            heat, warm = follow(heat, square, square, none, self.cooling[:active])
            out[:, k] = np.maximum(1.0 - self.heating[:active] * warm, 0.0)
        self.heat[:active] = heat
        return out

    def _bounds(self, speed: np.ndarray, active: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest torque at a speed (active, n), each (active, 1, n)."""
        parts = (a[:active] for a in (self.limit, self.stall, self.no_load))
        return torque_bounds(speed[:, None], *parts)
