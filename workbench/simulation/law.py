"""Torque of a log without torque: what a stated loop gave along the measured motion."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from workbench.core import Recording
from workbench.effects import Plant

from .control import control_law
from .experiment import prepare
from .trajectory import Track


def law_torque(
    recording: Recording, plant: Plant, track: Track, ahead: float = 0.0, *, window: float = 1.0
) -> np.ndarray:
    """Return the drives' torque (N, n), actuator coordinates; its mean over a row's time from each row.

    The loop reads the motion at each of its ticks, between rows too, holds its command until the next one,
    and the model's delay and torque limits follow.

    Args:
        recording: a loop that is known, with its reference.
        plant: whose delay and limits the drives have.
        track: the motion, actuator coordinates.
        ahead: share of a row by which the mean begins before its row: 0.5 has the row in its middle.
        window: share of a row's time over which the mean is taken.
    """
    e = prepare(recording, plant.model)
    c = control_law(e, plant, None)
    rows = len(track.position)
    position = CubicSpline(np.arange(rows), track.position)
    at = e.ticks / e.stride
    read = position(at) @ c.read.T
    if c.differentiates:
        rate = (read - position(at - c.period / recording.period) @ c.read.T) / c.period
        rate[at < c.period / recording.period] = 0.0
    else:
        rate = CubicSpline(np.arange(rows), track.velocity)(at) @ c.read.T
    away, slower = c.reference - read @ c.sense.T, c.rate - rate @ c.sense.T
    law = c.output * np.clip(c.kp * away + c.kd * slower, -c.limit, c.limit)
    constant = c.constant[np.minimum(e.ticks // e.stride, rows - 1)] if c.per_row else c.constant
    torque = np.clip(law @ c.drive.T + constant, -plant.chain.limit, plant.chain.limit)
    late = plant.chain.delay_s / recording.period if recording.timing.delay == "motor" else 0.0
    # the integral of a held torque is exact between ticks, so that any delay and any row's mean are
    edges = np.append(at, rows)
    whole = np.concatenate([np.zeros((1, len(c.kp))), np.cumsum(torque * np.diff(edges)[:, None], axis=0)])
    begin = np.arange(rows) - late - ahead
    before, after = (
        np.stack([np.interp(moments, edges, x, left=0.0) for x in whole.T], axis=1)
        for moments in (begin, begin + window)
    )
    return (after - before) / window
