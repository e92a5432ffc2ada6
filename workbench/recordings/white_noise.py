"""White noise of a signal: the part in short windows that neither slow motion nor a command explains."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy.special import gammaincinv

WINDOW = 200  # rows; short beside any change of configuration, long enough to separate bands
WINDOWS = 80  # per axis; more would sharpen the median below 1 %, which nothing needs
BANDS = (0.25, 0.4, 0.6)  # parts of half the row rate taken to be motion; the rest is noise
_CLEARLY = 0.7  # of all rows' noise: of kinds that are alike one is quieter by chance, but not by so much
_REACH_S = 0.010  # a torque answers its command within delay and current loop, well inside this


def white_noise(
    signal: np.ndarray,
    valid: np.ndarray,
    command: np.ndarray | None = None,
    period: float = 1.0,
    *,
    integrated: bool = False,
    phase: np.ndarray | None = None,
    guessed: np.ndarray | None = None,
    bands: Sequence[float] = BANDS,
) -> float:
    """Return the standard deviation of the white noise on one signal.

    Args:
        signal: shape (N,).
        valid: rows to trust, shape (N,) bool.
        command: what the signal follows with some delay and lag, shape (N, m), or None.
        period: row period [s].
        integrated: the signal follows the command's integral, and never the same row's.
        phase: number (N,) of each row; rows of another number follow the command in another way.
        guessed: rows (N,) bool that have no noise of their own.
        bands: parts of half the row rate that are taken to be motion, one after the other; the least counts.

    Returns:
        The standard deviation, in the signal's unit; NaN where there are too few rows.
    """
    twice = command is not None and np.allclose(command[:, 0], signal, rtol=1e-9, atol=0)
    if command is None or np.ptp(command) == 0 or twice:
        lags = 0  # nothing to follow, or the same column twice
    else:
        lags = int(np.clip(np.ceil(_REACH_S / period), 4, 80)) + 1
    kinds = 1 if phase is None else int(phase.max()) + 1
    columns = lags * kinds * (1 if command is None else command.shape[1])
    gaps = np.concatenate([[0], np.cumsum(~valid)])
    width = min(max(WINDOW, 6 * columns), len(signal) - lags)
    starts = np.zeros(0, int)
    while len(starts) == 0:  # where gaps leave no room, shorter ones
        width -= width % kinds  # all windows begin with the same kind
        if width < max(16, 3 * columns):
            return float("nan")
        starts = np.arange(lags + integrated, len(signal) - width + 1, width)
        starts = starts[gaps[starts + width] == gaps[starts - lags]]
        width //= 1 if len(starts) else 2
    starts = starts[np.linspace(0, len(starts) - 1, min(WINDOWS, len(starts))).astype(int)]
    rows = starts[:, None] + np.arange(width)
    followed = None
    if command is not None and lags:
        taken = rows[:, :, None] - np.arange(lags) - (1 if integrated else 0)
        followed = command[taken].reshape(*rows.shape, -1)  # (windows, width, lags * m)
        followed = np.cumsum(followed, axis=1) if integrated else followed
        if phase is not None:
            of_kind = (phase[rows][:, :, None] == np.arange(kinds)).astype(float)
            followed = np.einsum("wri,wrk->wrik", followed, of_kind).reshape(*rows.shape, -1)
    if guessed is not None:
        own = _each_by_itself(guessed[rows])
        followed = own if followed is None else np.concatenate([followed, own], axis=2)
    slow = [round(width * band) for band in bands]
    left = [_outside(signal[rows], followed, count) for count in slow]
    every = min(_usual(*each) for each in left)
    if followed is None or phase is None:
        return every
    quietest = _of_quietest(*left[0], slow[0], phase[rows[0]])
    return quietest if quietest < _CLEARLY * every else every


def _each_by_itself(chosen: np.ndarray) -> np.ndarray:
    """Return columns (W, width, most) that select, and thereby remove, one chosen row (W, width) each."""
    most = int(chosen.sum(axis=1).max(initial=0))
    row = np.argsort(~chosen, axis=1, kind="stable")[:, None, :most]
    columns = np.zeros((*chosen.shape, most))
    np.put_along_axis(columns, row, 1.0, axis=1)
    return columns * chosen[:, :, None]


def _outside(windows: np.ndarray, followed: np.ndarray | None, slow: int) -> tuple[np.ndarray, np.ndarray]:
    """Return windows (W, width) outside `slow` cosines and commands, and their freedom (W,)."""
    width = windows.shape[1]
    basis = _slow_basis(width, slow)
    rest = windows - (windows @ basis) @ basis.T
    freedom = np.full(len(windows), float(width - basis.shape[1]))
    if followed is not None:
        commands = followed - basis @ (basis.T @ followed)
        across = np.swapaxes(commands, 1, 2)
        size, turned = np.linalg.eigh(across @ commands)
        # directions that only rounding sets apart explain nothing
        told = size > 1e-11 * size[:, -1:] + 1e-24
        along = (np.swapaxes(turned, 1, 2) @ (across @ rest[:, :, None]))[:, :, 0]
        share = np.where(told, along / np.where(told, size, 1.0), 0.0)
        rest = rest - (commands @ (turned @ share[:, :, None]))[:, :, 0]
        freedom -= told.sum(axis=1)
    return rest, freedom


def _usual(rest: np.ndarray, freedom: np.ndarray) -> float:
    """Return the noise that leaves this much with this freedom, median over windows."""
    median = 2.0 * gammaincinv(0.5 * np.maximum(freedom, 1), 0.5)  # of a chi-squared variable
    return float(np.sqrt(np.median((rest**2).sum(axis=1) / median)))


def _of_quietest(rest: np.ndarray, freedom: np.ndarray, slow: int, kind: np.ndarray) -> float:
    """Return the same for the kind of rows with the least noise; (width,) kinds, equal in all windows.

    Where a row's torque answers a tick that no row shows, the noise that sensors had at that tick is in it,
    by the loop's gains. The kind whose ticks are logged shows the torque's own.
    """
    basis = _slow_basis(len(kind), slow)
    of_kind = (kind[:, None] == np.unique(kind)).astype(float)
    # slow cosines that take of a row take of its neighbours too, which are of other kinds
    mixed = of_kind.T @ (np.eye(len(kind)) - basis @ basis.T) ** 2 @ of_kind / of_kind.sum(axis=0)[:, None]
    power = np.median(rest**2 @ of_kind, axis=0) / of_kind.sum(axis=0)
    taken = np.median(freedom) / (len(kind) - basis.shape[1])  # by the commands, of all kinds alike
    own = np.linalg.solve(mixed, power / taken)
    return float(np.sqrt(own.min())) if own.min() > 0.0 else np.inf


@lru_cache(maxsize=32)
def _slow_basis(width: int, count: int) -> np.ndarray:
    """Return orthonormal cosines and the odd powers missing at a window's ends, (width, count + 2)."""
    place = (np.arange(width) + 0.5) / width
    cosines = np.cos(np.pi * place[:, None] * np.arange(count))
    ends = np.column_stack([place - 0.5, (place - 0.5) ** 3])
    return np.linalg.qr(np.hstack([cosines, ends]))[0]
