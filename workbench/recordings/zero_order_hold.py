"""Signals that a loop holds between its ticks, from rows that were not sampled at those ticks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

_FEW = 12  # changes that say nothing
_BESIDE = 0.5  # a row this close to a tick may show the command before or after [rows]
_MOST = 0.9  # of the changes of a held signal lie beside a tick
_NO_LESS = 0.01  # share of changes that tells one phase from another
_SHARP = 0.4  # power of what a signal that stands between steps moves there by its noise, over that in steps
_PHASES = 300  # that are tried at first
_DIGITS = 6  # of a phase, as a share of the period: nearer rows are at one
_BEHIND = 0.01  # of the way from one row's phase to the next
_MIXED = 0.03  # of the pairs of rows without a tick in between differ all the same
_PAIRS = 20_000  # of successive rows, enough to tell a phase


def ticks(times: np.ndarray, values: np.ndarray, period: float | None) -> tuple[float, float] | None:
    """Return the ticks of the loop that made a held signal, from rows at other times.

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
        """Return the share of the changes that have a tick between their rows, or such a size beside them."""
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
    """Return a held signal at any times (M,), given the ticks of its loop: the middle row of each tick.

    Rows beside a tick may be older or newer than they say, or a mixture that a logger interpolated.
    """
    amid = phase + period * (np.floor((at - phase) / period + 1e-6) + 0.5)
    return values[nearest_row(times, amid)]


def nearest_row(times: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the row (M,) nearest to each time (M,); of two equally near, the later."""
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    return after - (at - times[after - 1] < times[after] - at)


def shared_ticks(times: np.ndarray, values: np.ndarray, period: float) -> float | None:
    """Return the ticks of a loop about as fast as jittering rows, if some rows repeat one tick's command.

    Args:
        times: of the rows (K,) [s].
        values: the signal (K, k), equal in rows of one tick.
        period: of the loop [s].

    Returns:
        The phase of its ticks [s]; None where equal rows do not tell.
    """
    equal = np.all(np.diff(values, axis=0) == 0, axis=1)
    if equal.sum() < _FEW or (~equal).sum() < _FEW:
        return None
    ends = np.stack([times[:-1], times[1:]])

    def alike(phase: float) -> tuple[int, int]:
        """Return the pairs of rows without a tick between them: the equal ones and the different ones."""
        then, now = np.floor((ends - phase) / period)
        return int(np.sum(equal & (now == then))), int(np.sum(~equal & (now == then)))

    phase = _best(_behind_rows(times, period), lambda x: alike(x)[1] / _MIXED - alike(x)[0])
    same, other = alike(phase)
    # more than chance has of them: a signal that often stands still is equal across ticks too
    told = same >= _FEW and other <= _MIXED * same
    return phase if told and other * equal.sum() < 0.5 * same * (~equal).sum() else None


def _behind_rows(times: np.ndarray, period: float) -> np.ndarray:
    """Phases just after those of the rows, ascending [s]; all phases between two of them are equivalent."""
    own = period * np.unique(np.round(times / period % 1.0, _DIGITS) % 1.0)
    return own + _BEHIND * np.diff(own, append=own[0] + period)


def _best(phases: np.ndarray, cost: Callable[[float], float]) -> float:
    """Return the phase of least cost: a coarse search, then all phases near the best."""
    stride = max(1, len(phases) // _PHASES)
    best = stride * int(np.argmin([cost(float(phase)) for phase in phases[::stride]]))
    near = phases[np.arange(best - stride, best + stride + 1) % len(phases)]
    return float(min(near, key=cost))


def step_phase(times: np.ndarray, values: np.ndarray, period: float) -> tuple[float, np.ndarray] | None:
    """Return the phase in a loop's period at which a delayed torque steps, if constant between steps.

    Args:
        times: of the rows (K,) [s].
        values: the signal (K, k), noisy.
        period: of the loop [s].

    Returns:
        The phase of the steps [s]: of those that tell rows alike, right behind the last row before a step,
        since a loop that ticks with the clock has its step at a row of the clock, which shows it. And which
        columns stand still between steps, (k,) bool. None where none does.
    """
    scale = np.maximum(np.std(values, axis=0), 1e-300)
    some = np.unique(np.linspace(0, len(times) - 2, min(len(times) - 1, _PAIRS)).astype(int))
    moved = ((values[some + 1] - values[some]) / scale) ** 2
    ends = np.stack([times[some], times[some + 1]])

    def between(phase: float) -> np.ndarray:
        """Return the share of each column's motion that happens between steps."""
        ticks_then, ticks_now = np.floor((ends - phase) / period)
        across = ticks_now > ticks_then
        if across.sum() < _FEW or (~across).sum() < _FEW:
            return np.full(moved.shape[1], np.inf)
        return moved[~across].mean(axis=0) / np.maximum(moved[across].mean(axis=0), 1e-300)

    phase = _best(_behind_rows(ends, period), lambda x: float(between(x).min()))
    still = between(phase) < _SHARP
    return (phase, still) if still.any() else None


def nearest_between_steps(times: np.ndarray, phase: float, period: float, at: np.ndarray) -> np.ndarray:
    """Return the row (M,) nearest to each time (M,) without a step in between, if there is one."""
    tick, wanted = (np.floor((t - phase) / period) for t in (times, at))
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    before = after - 1
    nearer_before = at - times[before] < times[after] - at
    only_before = (tick[before] == wanted) & (tick[after] != wanted)
    only_after = (tick[after] == wanted) & (tick[before] != wanted)
    return np.where(only_before | (nearer_before & ~only_after), before, after)
