"""The clock of a log: rounding of its time stamps, jitter, and missing rows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core import InputError
from workbench.core.text import counted

_MISSING = 1.5  # an increment longer than this many periods hides a row,
_USUAL = 1.3  # and longer than this many of those that are long but usual where a clock is not even
_ROW_LATE = 0.75  # later rows that are late by this many periods lack a row
_SURELY = 2.5  # a stamp later than this hides rows, whatever those after it say [periods]
_MOST_HIDDEN = 20  # a log of which one row in so many is there says nothing; and a clock has to fit in memory
_STRAIGHT = 1e-3  # rows this close to a uniform clock, in periods, are on it


@dataclass(frozen=True)
class Clock:
    """The position of a table's rows on a uniform clock.

    Attributes:
        time: the uniform clock [s], shape (M,), from 0.
        logged: times of the table's rows that are kept, from 0 [s], shape (K,).
        row: for rows on the uniform clock, the clock's index of each kept row, shape (K,); None where
            the clock jitters and signals must be interpolated.
        kept: indices of the kept rows in the table, shape (K,).
        jitter: rms deviation of the increments from the period, as a part of it.
        widest: longest increment that hides no row [s].
    """

    time: np.ndarray
    logged: np.ndarray
    row: np.ndarray | None
    kept: np.ndarray
    jitter: float
    widest: float

    @property
    def late_s(self) -> float:
        """Return the rms distance of the rows from the clock's times [s]; 0 if the clock does not jitter."""
        if self.row is not None:
            return 0.0
        places = self.logged / self.time[1]
        return float(np.std(places - np.round(places)) * self.time[1])

    @property
    def whole(self) -> bool:
        """Return whether the table's rows are exactly the clock's rows."""
        return self.row is not None and len(self.row) == len(self.time)


def read_clock(seconds: np.ndarray, valid: np.ndarray | None, column: str, path: Path) -> Clock:
    """Check the time column and find the uniform clock behind it.

    Args:
        seconds: time of every row [s], shape (N,).
        valid: rows that were measured, shape (N,) bool, or None where the log does not say.
        column, path: for error texts.

    Raises:
        InputError: fewer than two rows, time that is not a number, goes back, repeats, or jumps
            without a `valid` column.
    """
    measured = np.ones(len(seconds), bool) if valid is None else valid
    finite = np.isfinite(seconds)
    if not finite[measured].all():
        bad = int(np.flatnonzero(measured & ~finite)[0])
        remedy = "remove the row, or mark it in a `valid` column"
        raise InputError("time is not a number", file=path, column=column, row=bad + 1, remedy=remedy)
    kept = np.flatnonzero(finite)
    if len(kept) < 2:
        remedy = "record at least two rows"
        raise InputError(
            f"{counted(len(kept), 'row')}: too few for a recording", file=path, column=column, remedy=remedy
        )
    t = seconds[kept]
    step = np.diff(t)
    _check_forward(step, kept, column, path)
    period = float(np.median(step))
    widest = max(_MISSING * period, _USUAL * float(np.quantile(step, 0.95)))
    wide = np.flatnonzero(step > widest)
    if valid is None and len(gaps := _gaps(t, float(step[step <= widest].mean()), wide)):
        bad = int(gaps[0])
        raise InputError(
            f"time jumps by {step[bad] / period:.4g} periods, from {t[bad]:.6g} s to {t[bad + 1]:.6g} s",
            file=path, column=column, row=int(kept[bad + 1]) + 1,
            remedy="cut the recording there, or add a `valid` column to have the gap filled and masked",
        )  # fmt: skip
    if t[-1] - t[0] > _MOST_HIDDEN * len(t) * period:
        bad = int(np.argmax(step))
        raise InputError(
            f"{t[-1] - t[0]:.4g} s hold {len(t)} rows of {period:.4g} s: time jumps by {step[bad]:.4g} s",
            file=path, column=column, row=int(kept[bad + 1]) + 1, remedy="cut the recording there",
        )  # fmt: skip
    hidden = np.ones(len(step)) if valid is None else np.maximum(1, np.round(step / period))
    row = np.concatenate([[0], np.cumsum(hidden)]).astype(int)
    straight = np.polynomial.Polynomial.fit(row, t, 1)
    start, exact = straight.convert().coef
    off = float(np.abs(t - start - exact * row).max())
    tolerance = max(_STRAIGHT * exact, _rounding(t))
    if off <= tolerance:
        exact = _short(exact, (2 * off + 1e-9 * exact) / row[-1])
        plain = float(f"{exact:.4g}")  # 0.004, where its single-precision neighbour was summed up
        exact = plain if abs(plain - exact) < 6e-8 * exact else exact
        return Clock(np.arange(row[-1] + 1) * exact, row * exact, row, kept, 0.0, widest)
    # a straight line through N late stamps has a slope off by twelve times their variance, over N^3
    spread = float(np.std(t - start - exact * row))
    if spread < exact:
        period = _short(exact, 3 * spread * np.sqrt(12 / len(t)) / row[-1])
        logged = t - np.mean(t - period * row)
    else:  # a log that changes its rate
        logged = t - t[0]
    jitter = float(np.sqrt(np.mean((step[step < widest] / period - 1) ** 2)))
    count = int(np.floor(logged[-1] / period + 0.5))
    return Clock(np.arange(count + 1) * period, logged, None, kept, jitter, widest)


def _gaps(t: np.ndarray, period: float, wide: np.ndarray) -> np.ndarray:
    """Return which wide time steps hide missing rows: then all later rows are late, not one stamp only.

    Where all later rows are late by a part of a row, the logger paused and lost nothing.
    """
    place = t - period * np.arange(len(t))
    around = 20
    missing = [
        k
        for k in wide
        if t[k + 1] - t[k] > _SURELY * period
        or np.median(place[k + 1 : k + 1 + around]) - np.median(place[max(0, k + 1 - around) : k + 1])
        > _ROW_LATE * period
    ]
    return np.array(missing, int)


def _check_forward(step: np.ndarray, kept: np.ndarray, column: str, path: Path) -> None:
    least = 1e-9 * max(0.0, float(np.median(step)))  # less is lost in the rounding of the times themselves
    if (step > least).all():
        return
    bad = int(np.argmax(step <= least))
    what = "repeats" if step[bad] >= 0 else f"goes back by {-step[bad]:.4g} s"
    remedy = "sort the rows by time, and leave out what was logged twice"
    raise InputError(f"time {what}", file=path, column=column, row=int(kept[bad + 1]) + 1, remedy=remedy)


def _rounding(t: np.ndarray) -> float:
    """Return the step to which the times were rounded when written [s]; 0 if they were not.

    A clock of 1/3 ms printed with four decimals has increments that differ by a third, and no jitter.
    """
    for decimals in range(10):
        if np.abs(np.round(t, decimals) - t).max() < 1e-12 * max(1.0, abs(t[-1])):
            return 10.0**-decimals
    single = t.astype(np.float32)
    return float(np.spacing(np.abs(single).max())) if (single == t).all() else 0.0


def _short(value: float, tolerance: float) -> float:
    """Return the shortest number within the tolerance: 0.001 rather than 0.00099999996."""
    for digits in range(1, 16):
        short = float(f"{value:.{digits}g}")
        if abs(short - value) <= tolerance:
            return short
    return value
