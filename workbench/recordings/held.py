"""Signals that a loop holds between its ticks, from rows that were not taken at those ticks."""

from __future__ import annotations

import numpy as np

_FEW = 12  # changes that say nothing
_BESIDE = 0.5  # a row this close to a tick may show the command before or after [rows]
_MOST = 0.9  # of the changes of a held signal lie beside a tick
_NO_LESS = 0.01  # share of changes that tells one phase from another
_SHARP = 0.1  # what a signal that stands between its steps moves there, of what it moves in them (power)


def ticks(times: np.ndarray, values: np.ndarray, period: float | None) -> tuple[float, float] | None:
    """When the loop that made a held signal ticked, from rows at times that are none of its ticks.

    Args:
        times: of the rows (K,) [s].
        values: the held signal (K, k).
        period: of the loop [s]; None takes the usual distance of two changes.

    Returns:
        ``(phase, period)``: ticks are at ``phase + n period`` [s]; None where no such clock made the changes,
        or where it ticks too often for rows to show it.
    """
    change = np.flatnonzero(np.any(np.diff(values, axis=0) != 0, axis=1))
    if len(change) < _FEW:
        return None
    row = float(np.median(np.diff(times)))
    period = period or row * float(np.round(np.median(np.diff(times[change])) / row))
    if period < 1.5 * row:
        return None
    beside = row * min(_BESIDE, 0.25 * (period / row - 1.0))
    before, after = times[change], times[change + 1]

    def told(phase: float, slack: float) -> float:
        """Share of the changes that have a tick between their rows, or so much beside them."""
        last, first = (after + slack - phase) / period, (before - slack - phase) / period
        return float(np.mean(np.floor(last + 1e-9) > np.floor(first + 1e-9)))

    phases = np.arange(0.0, period, row / 10)
    share = np.array([told(phase, beside) for phase in phases])
    # where several will do, the one that needs no slack
    fit = share + np.array([told(phase, 0.0) for phase in phases])
    if share[np.argmax(fit)] < _MOST:
        return None
    # the contract's loop ticks at the first row; another one may tick at any time
    if fit[0] >= fit.max() - _NO_LESS:
        return 0.0, period
    # the middle of the phases that will do, which may lie across the end of the period
    fits = np.exp(2j * np.pi * phases[fit >= fit.max() - _NO_LESS] / period).mean()
    return float(np.angle(fits) / (2 * np.pi) * period), period


def held_by(times: np.ndarray, values: np.ndarray, phase: float, period: float, at: np.ndarray) -> np.ndarray:
    """A held signal at any times (M,), given the ticks of its loop: what the row amid each tick shows.

    Rows beside a tick may be older or newer than they say, or a mixture that a logger interpolated.
    """
    amid = phase + period * (np.floor((at - phase) / period + 1e-6) + 0.5)
    return values[nearest_row(times, amid)]


def nearest_row(times: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The row (M,) nearest to each time (M,); of two as near, the later."""
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    return after - (at - times[after - 1] < times[after] - at)


def step_phase(times: np.ndarray, values: np.ndarray, period: float) -> float | None:
    """When in a loop's period a torque behind its command steps, if it stands still between steps.

    Args:
        times: of the rows (K,) [s].
        values: the signal (K, k), noisy.
        period: of the loop [s].

    Returns:
        The phase of the steps [s]; None where the signal moves between them too.
    """
    row = float(np.median(np.diff(times)))
    moved = np.mean((np.diff(values, axis=0) / np.maximum(np.std(values, axis=0), 1e-300)) ** 2, axis=1)
    best = (np.inf, 0.0)
    for phase in np.arange(0.0, period, row / 10):
        tick = np.floor((times - phase) / period + 1e-6)
        across = np.diff(tick) > 0
        if across.sum() < _FEW or (~across).sum() < _FEW:
            return None
        best = min(best, (float(moved[~across].mean() / max(moved[across].mean(), 1e-300)), float(phase)))
    return best[1] if best[0] < _SHARP else None


def nearest_between_steps(times: np.ndarray, phase: float, period: float, at: np.ndarray) -> np.ndarray:
    """The row (M,) nearest to each time (M,) that has no step in between, where there is one."""
    tick, wanted = (np.floor((t - phase) / period + 1e-6) for t in (times, at))
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    before = after - 1
    nearer_before = at - times[before] < times[after] - at
    only_before = (tick[before] == wanted) & (tick[after] != wanted)
    only_after = (tick[after] == wanted) & (tick[before] != wanted)
    return np.where(only_before | (nearer_before & ~only_after), before, after)
