"""Signals onto the uniform clock: interpolated where they are smooth, held where they were held."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from .clock import Clock

#: What is computed rather than measured, and so may be a staircase by design.
_HELD = ("torque_command", "torque_feedforward", "position_reference", "velocity_reference")


def onto_clock(name: str, rows: np.ndarray, measured: np.ndarray, clock: Clock) -> np.ndarray:
    """One signal on the clock.

    Args:
        name: the signal's name.
        rows: the table's rows, shape (N, k).
        measured: which of the table's rows were measured, shape (N,) bool; others are filled.
        clock: the clock, of M rows.

    Returns:
        The signal, shape (M, k), finite where the measured rows are.
    """
    if clock.whole and measured.all():
        return rows
    good = measured[clock.kept]
    source = rows[clock.kept][good]
    filled = _interpolate(name, clock.logged[good], source, clock.time)
    if clock.row is not None:
        filled[clock.row[good]] = source
    return filled


def measured_on_clock(measured: np.ndarray, clock: Clock) -> np.ndarray:
    """Which of the clock's rows lie beside a measured row, shape (M,) bool."""
    good = measured[clock.kept]
    if clock.row is not None:
        out = np.zeros(len(clock.time), bool)
        out[clock.row[good]] = True
        return out
    times = clock.logged[good]
    period = clock.time[1]
    after = np.clip(np.searchsorted(times, clock.time), 1, len(times) - 1)
    inside = (clock.time >= times[0] - 0.5 * period) & (clock.time <= times[-1] + 0.5 * period)
    return inside & (times[after] - times[after - 1] <= clock.widest)


def looks_held(signal: np.ndarray) -> bool:
    """Whether a signal (N, k) moves, but stands still from row to row for a good part of the time."""
    steps = np.diff(signal, axis=0)
    moving = np.any(steps != 0, axis=0)
    return bool(moving.any()) and float(np.mean(steps[:, moving] == 0)) > 0.3


def _interpolate(name: str, times: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    if name in _HELD and looks_held(values):
        before = np.clip(np.searchsorted(times, at + 1e-9 * at[-1], side="right") - 1, 0, None)
        return values[before]
    # monotone between rows: no overshoot across a gap or at an encoder's steps
    return PchipInterpolator(times, values, axis=0)(np.clip(at, times[0], times[-1]))
