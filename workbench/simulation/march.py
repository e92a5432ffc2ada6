"""Many small disturbances sent round linearised loops, all runs and columns side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from workbench.effects import follow

from .linear import Loop


@dataclass(frozen=True)
class Disturbance:
    """C small changes along one run of N rows, actuator coordinates.

    Attributes:
        torque: on the mechanism, the mean over each row's step, (C, N, n).
        taps: number of a column -> change of the torque at the tap (N, n) that the motion does not cause,
            such as a delay's; its share that drives the mechanism stands in `torque`.
        commands: the same of the torque that the controller asks for, from each row on.
        readings: number of a column -> change of what sensors read, position and rate, (2, N, n). The run
            still starts with the reading that it starts with, and so somewhere else.
    """

    torque: np.ndarray
    taps: Mapping[int, np.ndarray] = field(default_factory=dict)
    commands: Mapping[int, np.ndarray] = field(default_factory=dict)
    readings: Mapping[int, np.ndarray] = field(default_factory=dict)


def propagate(
    loops: Sequence[Loop], disturbances: Sequence[Disturbance]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Response of the position that is read and of the torque that is compared.

    Args:
        loops: one a run; any lengths, one row period.
        disturbances: one a run; the same number of columns for all.

    Returns:
        Per run ``(position, torque)``, each (N, n, C), in the recording's coordinates.
    """
    counts = {loop.drives.shape[1] for loop in loops}
    if len(counts) > 1:
        found: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        for count in counts:
            part = [i for i, loop in enumerate(loops) if loop.drives.shape[1] == count]
            answers = propagate([loops[i] for i in part], [disturbances[i] for i in part])
            found.update(zip(part, answers, strict=True))
        return [found[i] for i in range(len(loops))]
    order = sorted(range(len(loops)), key=lambda i: -loops[i].experiment.substeps)
    chosen = [loops[i] for i in order]
    position, tap = _March(chosen, [disturbances[i] for i in order]).run()
    out: list[tuple[np.ndarray, np.ndarray] | None] = [None] * len(loops)
    for slot, i in enumerate(order):
        loop, rows = chosen[slot], len(chosen[slot].transition)
        q = np.einsum("ij,kjc->kic", loop.read, position[slot, :rows])
        u = tap[slot, :rows]
        if not loop.at_command:
            for column, extra in disturbances[i].taps.items():
                u[:, :, column] += extra
        out[i] = (q, np.einsum("ij,kjc->kic", loop.tap, u))
    return [o for o in out if o is not None]


class _March:
    """The time loop, over all runs and columns together; runs are sorted longest first."""

    def __init__(self, loops: list[Loop], disturbances: list[Disturbance]) -> None:
        self.loops, self.disturbances = loops, disturbances
        e = loops[0].experiment
        self.step = e.step
        self.stride = np.array([loop.experiment.stride for loop in loops])
        if len({round(loop.experiment.step, 12) for loop in loops}) > 1 or len(set(self.stride)) > 1:
            raise ValueError("runs of one call share one row period")
        self.rows = max(len(loop.transition) for loop in loops)
        self.n = e.feedforward.shape[1]
        self.joints = loops[0].drives.shape[1]
        self.count = disturbances[0].torque.shape[0]
        steps = np.array([loop.delay for loop in loops]) / e.step
        self.whole = np.floor(steps + 1e-9).astype(int)
        self.fraction = np.where(steps - self.whole > 1e-9, steps - self.whole, 0.0)
        self.commands = self._some("commands", self.n)
        self.readings = self._some("readings", 2 * self.n)

    def run(self) -> tuple[np.ndarray, np.ndarray]:
        """Reading of the drives' position, and torque at the tap or command, (W, rows, n, C) each."""
        loops, n, count, runs = self.loops, self.n, self.count, len(self.loops)
        stride = int(self.stride[0])
        position = np.zeros((runs, self.rows, n, count))
        tap = np.zeros((runs, self.rows, n, count))
        ring = int(self.whole.max()) + 2
        history = np.zeros((ring, runs, n, count))
        command = np.zeros((runs, n, count))
        transition, entry, torque, passing, gain = self._stack()
        period = np.array(
            [e.controller.period_s or e.recording.period for e in (x.experiment for x in loops)]
        )[:, None, None]
        rate_by_ticks = np.array([loop.differentiates for loop in loops])[:, None, None]
        lag = np.stack([loop.lag for loop in loops])[:, :, None] / self.step
        lags, current = bool(lag.any()), np.zeros((runs, n, count))
        last = np.array([loop.experiment.substeps for loop in loops])
        ticks = np.zeros((runs, last.max() + 1), bool)
        for i, loop in enumerate(loops):
            ticks[i, loop.experiment.ticks] = True
        any_tick = np.any(ticks, axis=0)
        uniform = bool((ticks == ticks[0])[:, : last.min()].all())
        whole, fraction = self.whole, self.fraction[:, None, None]
        simple = bool((self.fraction == 0).all() and (whole == whole[0]).all())
        index = np.arange(runs)
        all_open = bool(passing.all())
        at_command = np.array([loop.at_command for loop in loops])[:, None, None]
        sensors = _Reading(loops, self.readings, count, self.step, int(last.max()))
        feedback = np.stack([loop.feedback for loop in loops])
        state = sensors.start()
        read = sensors.reading(state, 0, 0)[:, :n] * 0.0
        for k in range(int(last[0]) + 1):
            row = k // stride
            logged = k % stride == 0
            if any_tick[k] or logged or sensors.remembers:
                seen = sensors.reading(state, k, row)
                if logged:
                    position[:, row] = seen[:, :n]
                if any_tick[k]:
                    if rate_by_ticks.any():
                        by_ticks = (seen[:, :n] - read) / period
                        read = np.where(ticks[:, k, None, None], seen[:, :n], read)
                        seen = np.concatenate(
                            [seen[:, :n], np.where(rate_by_ticks, by_ticks, seen[:, n:])], axis=1
                        )
                    fresh = feedback @ seen
                    command = fresh if uniform else np.where(ticks[:, k, None, None], fresh, command)
            asked = command
            if self.commands is not None:
                asked = command.copy()
                asked[:, :, self.commands[0]] += self.commands[1][:, row]
            history[k % ring] = asked
            if simple:
                at = mean = history[(k - whole[0]) % ring]
            else:
                newer, older = history[(k - whole) % ring, index], history[(k - whole - 1) % ring, index]
                at = np.where(fraction > 0, older, newer)
                mean = (1 - fraction) * newer + fraction * older
            if not all_open:
                at, mean = at * passing[:, row], mean * passing[:, row]
            if lags:
                behind_now = current
                current, behind = follow(current, mean, mean, np.zeros(1), lag)
                at, mean = np.where(lag > 0, behind_now, at), np.where(lag > 0, behind, mean)
            if logged:
                tap[:, row] = np.where(at_command, asked, at)
            state = transition[:, row] @ state + entry[:, row] @ (gain[:, row] * mean + torque[:, row])
        return position, tap

    def _some(self, kind: str, width: int) -> tuple[list[int], np.ndarray] | None:
        """Columns that have a disturbance of a kind, and it, (W, rows, width, columns)."""
        chosen = sorted({c for d in self.disturbances for c in getattr(d, kind)})
        if not chosen:
            return None
        out = np.zeros((len(self.loops), self.rows, width, len(chosen)))
        for i, disturbance in enumerate(self.disturbances):
            for k, column in enumerate(chosen):
                values = getattr(disturbance, kind).get(column)
                if values is not None:
                    rows = values.shape[-2]
                    out[i, :rows, :, k] = values if values.ndim == 2 else np.concatenate([*values], axis=1)
        return chosen, out

    def _stack(self) -> tuple[np.ndarray, ...]:
        """Matrices of all runs on one clock; a run that has ended stands still."""
        runs, n, v = len(self.loops), self.n, self.joints
        transition = np.zeros((runs, self.rows, 2 * v, 2 * v))
        entry = np.zeros((runs, self.rows, 2 * v, n))
        torque = np.zeros((runs, self.rows, n, self.count))
        passing = np.ones((runs, self.rows, n, 1), bool)
        gain = np.ones((runs, self.rows, n, 1))
        for i, (loop, disturbance) in enumerate(zip(self.loops, self.disturbances, strict=True)):
            rows = len(loop.transition)
            transition[i, :rows], entry[i, :rows] = loop.transition, loop.entry
            torque[i, :rows] = np.moveaxis(disturbance.torque, 0, -1)
            passing[i, :rows, :, 0], gain[i, :rows, :, 0] = loop.open, loop.gain
        return transition, entry, torque, passing, gain


class _Reading:
    """What sensors make of small motions, for all runs: scale, lag, delay, and their own disturbances."""

    def __init__(
        self, loops: list[Loop], own: tuple[list[int], np.ndarray] | None, count: int, step: float, last: int
    ) -> None:
        self.loops, self.own, self.count = loops, own, count
        n = loops[0].drives.shape[0]
        self.n = n
        two = np.eye(2)
        self.map = np.stack([np.kron(two, loop.scale[:, None] * loop.drives) for loop in loops])
        lag = np.stack([loop.sensor_lag for loop in loops])[:, :, None]
        self.follow = 1.0 - np.where(lag > 0, np.exp(-step / np.where(lag > 0, lag, 1.0)), 0.0)
        late = np.array([loop.sensor_delay for loop in loops]) / step
        self.whole = np.floor(late + 1e-9).astype(int)
        self.part = np.where(late - self.whole > 1e-9, late - self.whole, 0.0)[:, None, None]
        self.lags, self.delays = bool((lag > 0).any()), bool((late > 0).any())
        self.remembers = self.lags or self.delays
        self.rate = np.zeros((len(loops), n, count))
        self.ring = np.zeros((int(self.whole.max()) + 2, len(loops), 2 * n, count))

    def start(self) -> np.ndarray:
        """State (W, 2v, C) at which every run reads what it did without the disturbance."""
        v = self.loops[0].drives.shape[1]
        state = np.zeros((len(self.loops), 2 * v, self.count))
        if self.own is not None:
            first = self.own[1][:, 0]
            for i, loop in enumerate(self.loops):
                back = np.kron(np.eye(2), loop.start / loop.scale)
                state[i][:, self.own[0]] = -back @ first[i]
        return state

    def reading(self, state: np.ndarray, step: int, row: int) -> np.ndarray:
        """Position and rate (W, 2n, C) that are read at a step; called at every step where it `remembers`."""
        seen = self.map @ state
        n = self.n
        if self.lags:
            self.rate += self.follow * (seen[:, n:] - self.rate)
            seen[:, n:] = self.rate
        if self.delays:
            size, runs = len(self.ring), np.arange(len(self.loops))
            if step == 0:
                self.ring[:] = seen
            self.ring[step % size] = seen
            newer, older = (
                self.ring[(step - self.whole) % size, runs],
                self.ring[(step - self.whole - 1) % size, runs],
            )
            seen = (1.0 - self.part) * newer + self.part * older
        if self.own is not None:
            seen[:, :, self.own[0]] += self.own[1][:, row]
        return seen
