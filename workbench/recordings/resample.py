"""Signals onto the uniform clock: moved along their slope, or held where the loop held them."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import PchipInterpolator

from .clock import Clock
from .held import held_by, nearest_between_steps, nearest_row, step_phase, ticks

#: What is computed rather than measured, and so may be a staircase by design.
_HELD = ("torque_command", "torque_feedforward", "position_reference", "velocity_reference")
_NEAR = 0.75  # rows this near are moved to a time of the clock rather than interpolated [periods]
_AROUND = 5  # rows that a slope is taken from


def onto_clock(
    name: str, rows: np.ndarray, measured: np.ndarray, clock: Clock, loop_s: float | None = None
) -> np.ndarray:
    """One signal on the clock.

    Args:
        name: the signal's name.
        rows: the table's rows, shape (N, k).
        measured: which of the table's rows were measured, shape (N,) bool; others are filled.
        clock: the clock, of M rows.
        loop_s: period at which the controller was sampled, where it is known [s].

    Returns:
        The signal, shape (M, k), finite where the measured rows are.
    """
    if clock.whole and measured.all():
        return rows
    good = measured[clock.kept]
    source = rows[clock.kept][good]
    filled = _resample(name, clock.logged[good], source, clock.time, loop_s)
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
    moving = np.ptp(signal, axis=0) > 1e-9 * np.abs(signal).max(initial=0.0)
    return bool(moving.any()) and float(np.mean(steps[:, moving] == 0, axis=0).min()) > 0.3


def _resample(
    name: str, times: np.ndarray, values: np.ndarray, at: np.ndarray, loop_s: float | None
) -> np.ndarray:
    if name in _HELD and looks_held(values):
        loop = ticks(times, values, loop_s)
        if loop is not None:
            return held_by(times, values, *loop, at)
        before = np.clip(np.searchsorted(times, at + 1e-9 * at[-1], side="right") - 1, 0, None)
        return values[before]
    nearest = nearest_row(times, at)
    off = at - times[nearest]
    near = np.abs(off) < _NEAR * at[1]
    # monotone between rows: no overshoot across a gap or at an encoder's steps
    between = PchipInterpolator(times, values, axis=0)(np.clip(at, times[0], times[-1]))
    if len(times) < _AROUND or not near.any():
        return between
    # interpolation averages two rows and hides some of their noise; a row moved along its slope keeps its own
    moved = values[nearest] + _slope(times, values)[nearest] * off[:, None]
    if name == "torque_measured" and loop_s and loop_s >= 2 * float(np.median(np.diff(times))):
        steps = step_phase(times, values, loop_s)
        if steps is not None:
            phase, still = steps
            moved[:, still] = values[nearest_between_steps(times, phase, loop_s, at)][:, still]
    return np.where(near[:, None], moved, between)


def _slope(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Of the straight line through each row and its neighbours, shape (K, k)."""
    t = sliding_window_view(np.pad(times, _AROUND // 2, mode="edge"), _AROUND)
    y = sliding_window_view(np.pad(values, ((_AROUND // 2,) * 2, (0, 0)), mode="edge"), _AROUND, axis=0)
    t = t - t.mean(axis=1, keepdims=True)
    return np.einsum("kj,kcj->kc", t, y) / np.sum(t**2, axis=1)[:, None]
