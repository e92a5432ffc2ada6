"""Signals resampled to the uniform clock: interpolated, or held where the loop held them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import PchipInterpolator

from .clock import Clock
from .zero_order_hold import held_by, nearest_between_steps, nearest_row, shared_ticks, step_phase, ticks

#: What is computed rather than measured, and so may be a staircase by design.
_HELD = ("torque_command", "torque_feedforward", "position_reference", "velocity_reference")
_NEAR = 0.75  # rows this near are moved to a time of the clock rather than interpolated [periods]
_NEXT = 1.5  # and ticks this near, of what has noise of its own
_UNSURE = 4.0  # standard deviations of the mean of rows' delays
_APART = 0.01  # of rows show another tick than they would if they were not early or late
_SLOWER = 2.0  # a loop that takes so many rows shows each of its ticks
_AROUND = 5  # rows that a slope is taken from
_REST = 4.0  # times the usual time between two changes: a signal that is equal for longer has come to rest


def onto_clock(
    name: str, rows: np.ndarray, measured: np.ndarray, clock: Clock, loop_s: float | None = None
) -> tuple[np.ndarray, np.ndarray | None]:
    """Return one signal on the clock, and which of its rows are guessed.

    Args:
        name: the signal's name.
        rows: the table's rows, shape (N, k).
        measured: which of the table's rows were measured, shape (N,) bool; others are filled.
        clock: the clock, of M rows.
        loop_s: period at which the controller was sampled, where it is known [s].

    Returns:
        The signal, shape (M, k), finite where the measured rows are; and the rows, shape (M,) bool, whose
        tick of the loop no row of the log shows, None where this is not known or all are shown.
    """
    if clock.whole and measured.all():
        return rows, None
    good = measured[clock.kept]
    times, source = clock.logged[good], rows[clock.kept][good]
    filled, guessed = _resample(name, times, source, clock.time, loop_s)
    if clock.row is None:
        return filled, guessed
    filled[clock.row[good]] = source
    return filled, None


def measured_on_clock(measured: np.ndarray, clock: Clock) -> np.ndarray:
    """Return which of the clock's rows lie beside a measured row, shape (M,) bool."""
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


def loop_keeps_time(
    signals: Mapping[str, np.ndarray], measured: np.ndarray, clock: Clock, loop_s: float | None
) -> bool:
    """Return whether rows of a jittering clock, some before, some after a tick, show a steady loop.

    Then rows were taken when their stamps say, and the loop read its sensors at other times.

    Args:
        signals: name -> the table's rows, shape (N, k).
        measured, loop_s: as for `onto_clock`.
        clock: one that jitters.
    """
    good = measured[clock.kept]
    times, row = clock.logged[good], clock.time[1]
    even = _behind_ticks(times, np.append(clock.time, clock.time[-1] + row))[
        np.round(times / row).astype(int)
    ]
    period = loop_s or float(np.median(np.diff(times)))
    for name in signals.keys() & set(_HELD):
        phase = shared_ticks(times, signals[name][clock.kept][good], period)
        if phase is not None:
            tick, of_even = (np.floor((t - phase) / period + 1e-9) for t in (times, even))
            if np.mean(tick != of_even) > _APART:
                return True
    return False


def looks_held(signal: np.ndarray) -> bool:
    """Return whether a signal (N, k) that moves is equal from row to row for a large part of the time.

    A smooth signal that rests now and then is equal for long, but not while it moves.
    """
    moving = np.ptp(signal, axis=0) > 1e-9 * np.abs(signal).max(initial=0.0)
    return bool(moving.any()) and min(_equal_share(column) for column in signal.T[moving]) > 0.3


def _equal_share(column: np.ndarray) -> float:
    """Return the share of rows (N,) equal to the row before, without rests between two motions."""
    apart = np.diff(np.flatnonzero(np.diff(column)), prepend=-1)
    apart = apart[apart <= _REST * np.median(apart)]
    return 1.0 - len(apart) / float(apart.sum())


def _resample(
    name: str, times: np.ndarray, values: np.ndarray, at: np.ndarray, loop_s: float | None
) -> tuple[np.ndarray, np.ndarray | None]:
    """Return a signal at other times (M,), and at which of these it has no row of its own nearby."""
    if name in _HELD and looks_held(values):
        loop = ticks(times, values, loop_s)
        if loop is not None:
            return held_by(times, values, *loop, at), None
        before = np.clip(np.searchsorted(times, at + 1e-9 * at[-1], side="right") - 1, 0, None)
        return values[before], None
    moved = _moved(times, values, at, _NEAR * at[1])
    row = float(np.median(np.diff(times)))
    period = loop_s or row
    if name == "torque_measured" and (steps := step_phase(times, values, period)):
        phase, still = steps
        if period >= _SLOWER * row:
            rows = nearest_between_steps(times, phase, period, _behind_ticks(times, at))
            found, guessed = values[rows], rows != nearest_row(times, at)
        else:
            found, guessed = _by_ticks(times, values, phase, period, at, _NEXT)
        moved[:, still] = found[:, still]
        return moved, guessed
    if name in _HELD and (phase := shared_ticks(times, values, period)) is not None:
        return _by_ticks(times, values, phase, period, at, 0.0)
    return moved, None


def _moved(times: np.ndarray, values: np.ndarray, at: np.ndarray, most: float) -> np.ndarray:
    """Return values at other times: of the nearest row if it is close enough, otherwise between two rows.

    Interpolation averages two rows and hides some of their noise; a row moved along its slope keeps its own.
    """
    nearest = nearest_row(times, at)
    off = at - times[nearest]
    near = np.abs(off) < most
    # monotone between rows: no overshoot across a gap or at an encoder's steps
    between = PchipInterpolator(times, values, axis=0)(np.clip(at, times[0], times[-1]))
    if len(times) < _AROUND or not near.any():
        return between
    moved = values[nearest] + _slope(times, values)[nearest] * off[:, None]
    return np.where(near[:, None], moved, between)


def _by_ticks(
    times: np.ndarray, values: np.ndarray, phase: float, period: float, at: np.ndarray, most: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return what a loop held at other times (M,), if rows belong to its ticks; and ticks no row shows.

    These are made of the ticks beside them: by one that is at most so many off, or between two.
    """
    shown, wanted = (np.floor((t - phase) / period + 1e-9) for t in (times, _behind_ticks(times, at)))
    tick, first = np.unique(shown, return_index=True)
    return _moved(tick, values[first], wanted, most), ~np.isin(wanted, tick)


def _behind_ticks(times: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return times of the clock just after ticks, as far as jittering rows show when a tick begins [s]."""
    row = float(np.median(np.diff(at)))
    late = float(np.std(times / row - np.round(times / row))) * row
    return at + _UNSURE * late / np.sqrt(len(times))


def _slope(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the slope of the straight line through each row and its neighbours, shape (K, k)."""
    t = sliding_window_view(np.pad(times, _AROUND // 2, mode="edge"), _AROUND)
    y = sliding_window_view(np.pad(values, ((_AROUND // 2,) * 2, (0, 0)), mode="edge"), _AROUND, axis=0)
    t = t - t.mean(axis=1, keepdims=True)
    return np.einsum("kj,kcj->kc", t, y) / np.sum(t**2, axis=1)[:, None]
