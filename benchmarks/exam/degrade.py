"""Worse logs from good ones: signals missing, a clock that jitters, fewer rows.

What is lost here is lost in the log only: the loop ran on the signals as they were. For a loop that itself
reads coarse or noisy sensors, give `VirtualLeg` other `Sensors`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import scipy

from workbench.core import InputError, Recording

#: Signals that stand still between ticks; a late look sees the row before or after, nothing in between.
_HELD = ("torque_command", "torque_measured")
_MOST = 0.45  # largest deviation of a row in periods, so that time never goes back


def degrade(
    recording: Recording,
    *,
    without: Collection[str] = (),
    jitter: float = 0.0,
    every: int = 1,
    seed: int = 0,
) -> Recording:
    """Return a copy of a recording as a poorer logger would have made it.

    Args:
        recording: with rows on a uniform clock.
        without: signals that were not logged, e.g. ``("velocity", "torque_measured")``. A recording without
            velocity is for writing and reading back, which derives one.
        jitter: standard deviation of the rows' times, in periods. The times are logged as they were, so that
            they are uniform again only once the recording has been written and read back.
        every: only each so-manieth row was logged.
        seed: of the jitter.

    Raises:
        InputError: position is left out, or a signal is named that the recording has not.
    """
    for name in {*without} - {*recording.signals}:
        raise InputError(f"'{recording.name}' has no signal '{name}'", remedy=", ".join(recording.signals))
    if "position" in without:
        raise InputError("a recording has to have a position", remedy="leave out another signal")
    time, signals = recording.time, dict(recording.signals)
    if jitter:
        time = _jittered(time, jitter, np.random.default_rng([seed, 11]))
        signals = {name: _looked_at(name, recording.time, rows, time) for name, rows in signals.items()}
    return replace(
        recording,
        time=time[::every],
        signals={name: rows[::every] for name, rows in signals.items() if name not in without},
        extra={name: rows[::every] for name, rows in recording.extra.items()},
        valid=recording.valid[::every],
    )


def _jittered(time: np.ndarray, jitter: float, generator: np.random.Generator) -> np.ndarray:
    """Times (N,) off their clock by normal deviations, cut before rows would change places [s]."""
    shift = np.clip(jitter * generator.standard_normal(len(time)), -_MOST, _MOST)
    shift[[0, -1]] = 0.0
    return time + shift * time[1]


def _looked_at(name: str, time: np.ndarray, rows: np.ndarray, at: np.ndarray) -> np.ndarray:
    """A signal (N, n) at other times (N,), none further off than a row: held, or moved on with its noise."""
    if name in _HELD:
        return rows[np.searchsorted(time, at + 1e-12, side="right") - 1]
    speed = scipy.signal.savgol_filter(rows, 7, 2, deriv=1, delta=time[1], axis=0)
    return rows + speed * (at - time)[:, None]
