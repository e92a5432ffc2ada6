"""How a small torque travels round the sampled loop: the closed loop linearised along a motion.

A torque T(t) that the model lacks, taken along the measured motion, changes what the model would have
done by S T, where S is the loop's response to a disturbance torque. For a system linear in its state
this is exact whatever the size of T, because both sides are evaluated on the motion that was made.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.effects import Plant

from .experiment import Experiment, differentiates, scored_torque
from .trajectory import Track, interpolate, joint_columns

_EVERY_S = 0.004  # posture and speed change little within this time


@dataclass(frozen=True)
class Loop:
    """One run linearised: plant matrices at rows, sampled feedback, delay.

    Attributes:
        transition: (N, 2n, 2n), state (q_s, rate) over one substep.
        entry: (N, 2n, n), torque in actuator coordinates, held over a substep.
        feedback: (n, 2n), state to torque command in actuator coordinates at a tick.
        read: (n, n), joint coordinates to the recording's.
        tap: (n, n), actuator torque to the recording's torque coordinates.
        gain: (n,), chain behind the tap.
        open: (N, n), False where the drive saturates and small changes are lost.
        experiment: timing.
        delay: [s].
        differentiates: whether the loop takes its rate from positions at successive ticks.
        at_command: whether the torque that is compared is the command, before delay and tap.
    """

    transition: np.ndarray
    entry: np.ndarray
    feedback: np.ndarray
    read: np.ndarray
    tap: np.ndarray
    gain: np.ndarray
    open: np.ndarray
    experiment: Experiment
    delay: float
    differentiates: bool
    at_command: bool


def linearise(plant: Plant, experiment: Experiment, track: Track) -> Loop:
    """Linearise mechanism and loop along a track; dry friction is left out (it has no slope)."""
    model, e = plant.model, experiment
    n, j = model.size, model.transmission
    back = np.linalg.inv(j)
    rows, inertia, damping, stiffness = _slopes(plant, track, e.recording.period)
    total = len(track.position)
    # M dqdd = dtau - C dw - K dq
    solve = np.linalg.inv(inertia)
    drift = np.zeros((len(rows), 2 * n, 2 * n))
    drift[:, :n, n:] = np.eye(n)
    drift[:, n:, :n], drift[:, n:, n:] = -solve @ stiffness, -solve @ damping
    push = np.zeros((len(rows), 2 * n, n))
    push[:, n:] = solve @ j.T
    h = e.step
    a = drift * h
    unit = np.eye(2 * n)
    a2 = a @ a
    transition = unit + a + a2 / 2 + a2 @ a / 6 + a2 @ a2 / 24
    entry = (unit + a / 2 + a2 / 6 + a2 @ a / 24) @ push * h
    c, feedback = e.controller, np.zeros((n, 2 * n))
    sense = (back if c.coordinates == "joint" else np.eye(n)) @ j
    drive = back.T if c.coordinates == "joint" else np.eye(n)
    if c.kind == "pd":
        feedback = -drive @ np.concatenate([np.diag(c.kp) @ sense, np.diag(c.kd) @ sense], axis=1)
    elif c.kind == "cascade_pv":
        gain = np.multiply(c.gain, c.kv)
        feedback = -drive @ np.concatenate([np.diag(gain * c.kp) @ sense, np.diag(gain) @ sense], axis=1)
    command = e.recording.get("torque_command")
    saturated = np.zeros((total, n), bool)
    if command is not None:
        limit = plant.chain.limit.copy()
        if c.kind == "cascade_pv" and c.limit:
            limit = np.minimum(limit, np.abs(np.multiply(c.gain, c.limit)))
        saturated = np.abs(command @ np.linalg.inv(e.to_actuator)) >= limit * (1 - 1e-9)
    return Loop(
        transition=interpolate(rows, transition, total),
        entry=interpolate(rows, entry, total),
        feedback=feedback,
        read=np.linalg.inv(e.to_actuator) @ j,
        tap=e.to_actuator.T,
        gain=plant.chain.gain,
        open=~saturated,
        experiment=e,
        delay=plant.chain.delay_s,
        differentiates=differentiates(e),
        at_command=scored_torque(e.recording) == "torque_command",
    )


def _slopes(plant: Plant, track: Track, period: float) -> tuple[np.ndarray, ...]:
    """Rows and, at these rows, M, C = d(inverse dynamics)/d(rate), K = d/d(position); joint coordinates."""
    m = copy.copy(plant.mujoco)
    m.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER  # the derivative functions know no Runge-Kutta
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)
    data = mujoco.MjData(m)
    back = np.linalg.inv(plant.model.transmission).T
    q, w, a = track.position @ back, track.velocity @ back, track.acceleration @ back
    stride = max(1, round(_EVERY_S / period))
    rows = np.unique(np.append(np.arange(0, len(q), stride), len(q) - 1))
    qpos, dofs = joint_columns(m, plant.model.joints)
    by_q, by_w, by_a = (np.zeros((m.nv, m.nv)) for _ in range(3))
    out = np.empty((3, len(rows), len(dofs), len(dofs)))
    pick = np.ix_(dofs, dofs)
    for k, row in enumerate(rows):
        data.qpos[qpos], data.qvel[dofs], data.qacc[dofs] = q[row], w[row], a[row]
        mujoco.mjd_inverseFD(m, data, 1e-6, False, by_q, by_w, by_a, None, None, None, None)
        # MuJoCo lays these out with one row per perturbed coordinate
        out[0, k], out[1, k], out[2, k] = by_a[pick].T, by_w[pick].T, by_q[pick].T
    return rows, out[0], out[1], out[2]


def propagate(
    loops: Sequence[Loop], torques: Sequence[np.ndarray], taps: Sequence[np.ndarray | None]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Response of position and measured torque to many small disturbances at once.

    Args:
        loops: one a run; any lengths.
        torques: per run (C, N, n), disturbance torque on the mechanism, actuator coordinates, mean over
            each row's step; the same C for all runs.
        taps: per run (C, N, n), change of the torque at the tap that is not caused by the motion, such
            as a delay's; its share that drives the mechanism stands in `torques`. None for none.

    Returns:
        Per run ``(position, torque)``, each (N, n, C), in the recording's coordinates.
    """
    order = sorted(range(len(loops)), key=lambda i: -loops[i].experiment.substeps)
    chosen = [loops[i] for i in order]
    march = _March(chosen, [torques[i] for i in order])
    position, tap = march.run()
    out: list[tuple[np.ndarray, np.ndarray] | None] = [None] * len(loops)
    for slot, i in enumerate(order):
        loop, rows = chosen[slot], len(chosen[slot].transition)
        q = np.einsum("ij,kjc->kic", loop.read, position[slot, :rows])
        u = tap[slot, :rows]
        extra = taps[i]
        if extra is not None and not loop.at_command:
            u = u + np.moveaxis(extra, 0, -1)
        out[i] = (q, np.einsum("ij,kjc->kic", loop.tap, u))
    return [o for o in out if o is not None]


class _March:
    """The time loop, over all runs and columns together; runs are sorted longest first."""

    def __init__(self, loops: list[Loop], torques: list[np.ndarray]) -> None:
        self.loops = loops
        e = loops[0].experiment
        self.stride = np.array([loop.experiment.stride for loop in loops])
        if len({round(loop.experiment.step, 12) for loop in loops}) > 1 or len(set(self.stride)) > 1:
            raise ValueError("runs of one call share one row period")
        self.rows = max(len(loop.transition) for loop in loops)
        self.n = e.feedforward.shape[1]
        self.count = torques[0].shape[0]
        self.torques = torques
        steps = np.array([loop.delay for loop in loops]) / e.step
        self.whole = np.floor(steps + 1e-9).astype(int)
        self.fraction = np.where(steps - self.whole > 1e-9, steps - self.whole, 0.0)

    def run(self) -> tuple[np.ndarray, np.ndarray]:
        loops, n, count, runs = self.loops, self.n, self.count, len(self.loops)
        stride = int(self.stride[0])
        position = np.zeros((runs, self.rows, n, count))
        tap = np.zeros((runs, self.rows, n, count))
        ring = int(self.whole.max()) + 2
        history = np.zeros((ring, runs, n, count))
        state, command = np.zeros((runs, 2 * n, count)), np.zeros((runs, n, count))
        transition, entry, torque, passing = self._stack()
        feedback = np.stack([loop.feedback for loop in loops])
        period = np.array(
            [e.controller.period_s or e.recording.period for e in (x.experiment for x in loops)]
        )
        rate_by_ticks = np.array([loop.differentiates for loop in loops])[:, None, None]
        read = np.zeros((runs, n, count))
        gain = np.stack([loop.gain for loop in loops])[:, :, None]
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
        for k in range(int(last[0]) + 1):
            row = k // stride
            if any_tick[k]:
                seen = state
                if rate_by_ticks.any():
                    by_ticks = (state[:, :n] - read) / period[:, None, None]
                    seen = np.concatenate(
                        [state[:, :n], np.where(rate_by_ticks, by_ticks, state[:, n:])], axis=1
                    )
                    read = np.where(ticks[:, k, None, None], state[:, :n], read)
                fresh = feedback @ seen
                command = fresh if uniform else np.where(ticks[:, k, None, None], fresh, command)
            history[k % ring] = command
            if simple:
                at = mean = history[(k - whole[0]) % ring]
            else:
                newer, older = history[(k - whole) % ring, index], history[(k - whole - 1) % ring, index]
                at = np.where(fraction > 0, older, newer)
                mean = (1 - fraction) * newer + fraction * older
            if not all_open:
                at, mean = at * passing[:, row], mean * passing[:, row]
            if k % stride == 0:
                position[:, row] = state[:, :n]
                tap[:, row] = np.where(at_command, command, at)
            state = transition[:, row] @ state + entry[:, row] @ (gain * mean + torque[:, row])
        return position, tap

    def _stack(self) -> tuple[np.ndarray, ...]:
        """Matrices of all runs on one clock; a run that has ended stands still."""
        runs, n = len(self.loops), self.n
        transition = np.zeros((runs, self.rows, 2 * n, 2 * n))
        entry = np.zeros((runs, self.rows, 2 * n, n))
        torque = np.zeros((runs, self.rows, n, self.count))
        passing = np.ones((runs, self.rows, n, 1), bool)
        for i, (loop, columns) in enumerate(zip(self.loops, self.torques, strict=True)):
            rows = len(loop.transition)
            transition[i, :rows], entry[i, :rows] = loop.transition, loop.entry
            torque[i, :rows] = np.moveaxis(columns, 0, -1)
            passing[i, :rows, :, 0] = loop.open
        return transition, entry, torque, passing
