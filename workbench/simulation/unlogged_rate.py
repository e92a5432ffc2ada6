"""The speed that a loop used when no speed was logged, from the logged command.

A loop may have a sensor of speed that the log leaves out, or differentiate its encoder from tick to tick. Its
law and its command, solved for the speed, say what it read.
"""

from __future__ import annotations

import numpy as np

from .experiment import Experiment

_ENOUGH = 50  # ticks


def rate_read(experiment: Experiment) -> tuple[np.ndarray, np.ndarray] | None:
    """Return rows at which the loop sampled and the speed (M, n) it read, in the recording's coordinates.

    None where the command was not logged as it was asked for, or the law knows no speed.
    """
    e, c = experiment, experiment.controller
    r, n = e.recording, e.recording.position.shape[1]
    command = r.get("torque_command")
    if command is None or c.kind not in ("pd", "cascade_pv") or r.timing.delay == "loop":
        return None
    rows = np.unique(e.ticks // e.stride)
    rows = rows[(rows > 0) & r.valid[np.minimum(rows, len(r) - 1)]]
    back = np.linalg.inv(e.transmission)
    sense = (back if c.coordinates == "joint" else np.eye(n)) @ e.to_actuator
    drive = back.T if c.coordinates == "joint" else np.eye(n)
    kp, kd = (np.multiply(c.kv, c.kp), np.array(c.kv)) if c.kind == "cascade_pv" else (c.kp, np.array(c.kd))
    output = np.array(c.gain) if c.kind == "cascade_pv" else np.ones(n)
    if not np.all(kd > 0):
        return None
    law = (command[rows] @ np.linalg.inv(e.to_actuator) - e.feedforward[rows]) @ np.linalg.inv(drive).T
    raw = law / output
    free = np.all(np.abs(raw) < (np.array(c.limit) if c.limit else np.inf) * (1 - 1e-6), axis=1)
    rows, raw = rows[free], raw[free]
    if len(rows) < _ENOUGH:
        return None
    away = e.reference[rows] - r.position[rows] @ sense.T
    rate = e.reference_rate[rows] - (raw - kp * away) / kd
    return rows, rate @ np.linalg.inv(sense).T


def differentiates(experiment: Experiment) -> bool:
    """Return whether the loop computes its speed as the difference of encoder readings from tick to tick.

    Where the controller does not say it: it does not where a speed was measured. Where none was, the command
    decides, and without one it does.
    """
    r = experiment.recording
    if experiment.controller.velocity is not None:
        return experiment.controller.velocity == "difference"
    if r.get("velocity") is not None and "velocity" not in r.derived:
        return False
    told = rate_read(experiment)
    if told is None or r.get("velocity") is None:
        return True
    rows, rate = told
    period = experiment.controller.period_s or r.period
    before = np.interp(r.time[rows] - period, r.time, np.arange(len(r)))
    by_difference = (r.position[rows] - r.position[np.round(before).astype(int)]) / period
    # stated gains may be wrong: whatever error and rate of the reference explain counts for neither
    others = np.concatenate(
        [experiment.reference[rows], experiment.reference_rate[rows], r.position[rows]], axis=1
    )
    left = [
        _unexplained(rate, np.concatenate([x, others], axis=1)) for x in (by_difference, r.velocity[rows])
    ]
    return bool(left[0] <= left[1])


def _unexplained(values: np.ndarray, by: np.ndarray) -> float:
    """Median size of what a linear combination of columns (M, k) leaves of values (M, n)."""
    by = np.concatenate([by, np.ones((len(by), 1))], axis=1)
    solution, *_ = np.linalg.lstsq(by, values, rcond=1e-12)
    return float(np.median(np.abs(values - by @ solution)))
