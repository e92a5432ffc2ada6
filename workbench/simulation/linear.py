"""Propagation of a small torque through the sampled loop: the closed loop, linearised along a motion.

A torque T(t) that the model lacks, taken along the measured motion, changes what the model would have
done by S T, where S is the loop's response to a disturbance torque. For a system linear in its state
this is exact whatever the size of T, because both sides are evaluated on the motion that was made.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import Controller
from workbench.effects import Plant, torque_bounds

from .carried import carried_slopes
from .control import true_controller
from .experiment import Experiment, scored_torque
from .native import inverse_slopes
from .trajectory import Track
from .unlogged_rate import differentiates

_EVERY_S = 0.004  # posture and speed change little within this time


@dataclass(frozen=True)
class Loop:
    """One linearised run: plant matrices at rows, sampled feedback, delay; v joints and n axes.

    Attributes:
        rows: (R,) rows at which the matrices are given; between them they change along straight lines.
        transition: (R, 2v, 2v), state (position and rate of MuJoCo's joints) over one substep.
        entry: (R, 2v, n), torque in actuator coordinates, held over a substep.
        drives: (n, v), joints to drives.
        start: (v, n), joints that move with a drive when everything is rigid.
        feedback: (n, 2n), reading of position and rate of the drives to the torque command at a tick.
        read: (n, n), actuator coordinates to the recording's.
        tap: (n, n), actuator torque to the recording's torque coordinates.
        gain: (N, n), chain behind the tap.
        lag: (n,), of the current loops [s].
        open: (N, n), False where the drive saturates and small changes are lost.
        scale: (n,), reading over true motion; `sensor_lag` (n,) [s] of the rate; `sensor_delay` [s].
        experiment: timing.
        delay: [s].
        differentiates: whether the loop takes its rate from positions at successive ticks.
        at_command: whether the torque that is compared is the command, before delay and tap.
    """

    rows: np.ndarray
    transition: np.ndarray
    entry: np.ndarray
    drives: np.ndarray
    start: np.ndarray
    feedback: np.ndarray
    read: np.ndarray
    tap: np.ndarray
    gain: np.ndarray
    lag: np.ndarray
    open: np.ndarray
    scale: np.ndarray
    sensor_lag: np.ndarray
    sensor_delay: float
    experiment: Experiment
    delay: float
    differentiates: bool
    at_command: bool


def linearise(plant: Plant, experiment: Experiment, track: Track, gain: np.ndarray | None = None) -> Loop:
    """Return mechanism and loop linearised along a track; dry friction, without a slope, is left out.

    `gain` (N, n) of the motors along the track, where it is not that of the chain.
    """
    model, e, chain = plant.model, experiment, plant.chain
    n, j = model.size, model.transmission
    rows, inertia, damping, stiffness = slopes(plant, track, e.recording.period)
    total, v = len(track.position), inertia.shape[-1]
    # M dqdd = dtau - C dw - K dq
    solve = np.linalg.inv(inertia)
    drift = np.zeros((len(rows), 2 * v, 2 * v))
    drift[:, :v, v:] = np.eye(v)
    drift[:, v:, :v], drift[:, v:, v:] = -solve @ stiffness, -solve @ damping
    push = np.zeros((len(rows), 2 * v, n))
    push[:, v:] = solve @ plant.drives.T
    transition, entry = _over_a_step(drift, push, e.step, plant.substeps)
    return Loop(
        rows=rows,
        transition=transition,
        entry=entry,
        drives=plant.drives,
        start=plant.lift @ np.linalg.inv(j),
        feedback=_feedback(true_controller(e.controller, chain), j),
        read=np.linalg.inv(e.to_actuator),
        tap=e.to_actuator.T,
        gain=np.tile(chain.gain, (total, 1)) if gain is None else gain,
        lag=chain.lag,
        open=~_saturated(plant, e, track),
        scale=chain.sensors.scale,
        sensor_lag=chain.sensors.lag,
        sensor_delay=chain.sensors.delay_s,
        experiment=e,
        delay=chain.delay_s,
        differentiates=differentiates(e),
        at_command=scored_torque(e.recording) == "torque_command",
    )


def _over_a_step(
    drift: np.ndarray, push: np.ndarray, step: float, parts: int
) -> tuple[np.ndarray, np.ndarray]:
    """Transition (N, k, k) and entry (N, k, n) over a step, by Runge-Kutta 4 in as many parts as MuJoCo."""
    h, unit = step / parts, np.eye(drift.shape[-1])
    a = drift * h
    a2 = a @ a
    once = unit + a + a2 / 2 + a2 @ a / 6 + a2 @ a2 / 24
    enter = (unit + a / 2 + a2 / 6 + a2 @ a / 24) @ push * h
    transition, entry = once, enter
    for _ in range(parts - 1):
        transition, entry = once @ transition, once @ entry + enter
    return transition, entry


def _feedback(c: Controller, j: np.ndarray) -> np.ndarray:
    """Slope of the torque command by what is read of position and rate of the drives, (n, 2n)."""
    n, back = len(j), np.linalg.inv(j)
    sense, drive = (back, back.T) if c.coordinates == "joint" else (np.eye(n), np.eye(n))
    if c.kind == "pd":
        return -drive @ np.concatenate([np.diag(c.kp) @ sense, np.diag(c.kd) @ sense], axis=1)
    if c.kind == "cascade_pv":
        gain = np.multiply(c.gain, c.kv)
        return -drive @ np.concatenate([np.diag(gain * c.kp) @ sense, np.diag(gain) @ sense], axis=1)
    return np.zeros((n, 2 * n))


def _saturated(plant: Plant, e: Experiment, track: Track) -> np.ndarray:
    """Rows and axes (N, n) where the torque that was asked for exceeds what the drive can give."""
    command, chain, c = e.recording.get("torque_command"), plant.chain, e.controller
    if command is None:
        return np.zeros(track.position.shape, bool)
    asked = command @ np.linalg.inv(e.to_actuator)
    low, high = torque_bounds(track.velocity, chain.limit, chain.stall, chain.no_load, chain.full_braking)
    if c.kind == "cascade_pv" and c.limit:
        ceiling = np.abs(np.multiply(c.gain, c.limit))
        low, high = np.maximum(low, -ceiling), np.minimum(high, ceiling)
    return (asked >= high * (1 - 1e-9)) | (asked <= low * (1 - 1e-9))


def slopes(plant: Plant, track: Track, period: float) -> tuple[np.ndarray, ...]:
    """Return rows and there M, C = d(inverse dynamics)/d(rate), K = d/d(position); joint coordinates."""
    m = copy.copy(plant.mujoco)
    m.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER  # the derivative functions know no Runge-Kutta
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)
    for i in range(m.ntendon):
        if m.tendon(i).name.startswith("flex:"):
            m.tendon_lengthspring[i] = 0.0  # a gap that is closed: within it nothing would hold the links
    back = np.linalg.inv(plant.model.transmission).T
    q, w, a = track.position @ back, track.velocity @ back, track.acceleration @ back
    stride = max(1, round(_EVERY_S / period))
    rows = np.unique(np.append(np.arange(0, len(q), stride), len(q) - 1))
    states = plant.state_at(np.stack([q[rows], w[rows]], axis=1))
    found = inverse_slopes(m, states, a[rows] @ plant.lift.T)
    if plant.model.carried is not None:
        found = found + plant.lift @ carried_slopes(plant, q[rows], w[rows], a[rows]) @ plant.lift.T
    return rows, *found
