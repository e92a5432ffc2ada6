"""Where a run begins that was logged in the middle of a motion: as its first rows and all that follow tell.

A few rows tell a speed to many times what a run can bear: an axis in a soft loop swings for long after it.
What the model makes of the beginning tells it far better. The numbers are those of the first rows, moved as
far as their own doubt allows to where the whole run comes nearest to what was measured.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core import Recording, SimulationError
from workbench.recordings.noise import position_levels

from .initial_state import doubt_of_start

_ROUNDS = 2  # of least squares; nearly linear
_FURTHEST = 3.0  # deviations of what the first rows say
_NONE = 1e-12  # rad or m: less noise than any
_FIRST_S = 2.0  # of a recording: by then a beginning is forgotten, or a model has gone its own way

#: Starts (B, 2, n) of drives -> their positions (B, N, n) without noise.
Simulate = Callable[[np.ndarray], np.ndarray]


def refined(start: np.ndarray, recording: Recording, simulate: Simulate) -> np.ndarray:
    """Return the start (2, n) of a run, in drive coordinates, nearer to that of the measured motion.

    Args:
        start: position and rate by the first rows.
        recording: in drive coordinates.
        simulate: the run from other starts.
    """
    doubt = doubt_of_start(recording)
    count = min(len(recording), max(2, round(_FIRST_S / recording.period)))
    counts = recording.valid[:count]
    noise = np.maximum(position_levels(recording)[1], _NONE)
    best, moved, least = start, np.zeros(start.size), np.inf
    for _ in range(_ROUNDS + 1):
        ways = moved + np.vstack([np.zeros(start.size), np.eye(start.size)])
        tried = start + doubt * ways.reshape(-1, *start.shape)
        try:
            runs = simulate(tried)
        except SimulationError:
            return best
        off = ((runs[:, :count] - recording.position[:count]) / noise)[:, counts].reshape(len(tried), -1)
        left = float(off[0] @ off[0] + moved @ moved)
        if not left < least:
            break
        best, least = tried[0], left
        slope = (off[1:] - off[0]).T
        rows, rest = np.concatenate([slope, np.eye(start.size)]), np.concatenate([off[0], moved])
        step = np.linalg.lstsq(rows, -rest, rcond=None)[0]
        moved = np.clip(moved + step, -_FURTHEST, _FURTHEST)
    return best
