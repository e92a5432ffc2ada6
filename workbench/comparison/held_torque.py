"""Whether a log's torque stands from row to row or is that of the row's time: the motion tells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.effects import Plant, smooth_sign
from workbench.simulation import required_torque

from .inverse import lowpass
from .measured_motion import Reading

_SAMPLED = 0.2  # rows; halfway to a held torque's half a row, less what a wrong model confuses


def holds(readings: Sequence[Reading], plant: Plant) -> np.ndarray:
    """Whether each drive's measured torque is held from row to row, (n,): what half a row too late tells.

    A log's torque is that at the row's time, or stands until the next. Half the torque's change over a row
    is fitted beside what a wrong model leaves: inertia, damping, friction, spring, gain and bias.
    """
    n = len(readings[0].held)
    if readings[0].name == "torque_command":
        return np.ones(n, bool)  # the drive holds it
    sums = [(np.zeros((7, 7)), np.zeros(7)) for _ in range(n)]
    for reading in readings:
        r, track = reading.recording, reading.track
        tap = r.signals[reading.name] @ np.linalg.inv(reading.to_actuator)
        needed = required_torque(plant, track, r.period, reading.rigid(plant))
        late = np.gradient(tap, axis=0)
        rest, needed, late = (lowpass(x, r) for x in (tap - needed, needed, late))
        counts = reading.counts @ np.abs(reading.to_actuator.T) >= np.abs(reading.to_actuator).sum(axis=1)
        for i, (gram, right) in enumerate(sums):
            q, w, a = track.position[:, i], track.velocity[:, i], track.acceleration[:, i]
            columns = [late[:, i], np.ones_like(q), q, w, a, smooth_sign(w), needed[:, i]]
            x = np.stack([c if k in (0, 6) else lowpass(c, r) for k, c in enumerate(columns)], axis=1)
            x, y = x[counts[:, i]], rest[counts[:, i], i]
            gram += x.T @ x
            right += x.T @ y
    shares = []
    for gram, right in sums:
        size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        solution = np.linalg.lstsq(gram / np.outer(size, size), right / size, rcond=1e-10)[0] / size
        shares.append(solution[0])
    # what is far from both is neither, but something else that is late or early
    sampled = np.abs(shares) < _SAMPLED
    return ~sampled
