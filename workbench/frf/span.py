"""The rows of a recording that hold whole periods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from workbench.core import InputError, Recording
from workbench.core.text import counted

from .period import periodic_rows
from .records import Choice, check_rows

_DRIFT = 0.02  # rows by which a period of whole rows may be off at the end of a recording


@dataclass(frozen=True, eq=False)
class Span:
    """Whole periods of one experiment; nothing is copied until it is asked for.

    Attributes:
        recording, choice: the experiment and its signals.
        period: in rows of the recording.
        rows: rows per period that `columns` gives.
        first, last: the recording's rows first to last - 1.
        count: how many periods.
    """

    recording: Recording
    choice: Choice
    period: float
    rows: int
    first: int
    last: int
    count: int

    @property
    def whole(self) -> bool:
        """Return whether a period is a whole number of rows."""
        return self.last - self.first == self.count * self.rows

    def columns(self, signals: Sequence[str] | None = None, periods: int | None = None) -> np.ndarray:
        """Return signals (all of the choice, if none are named) of the last `periods`, (periods rows, nz)."""
        count = min(periods or self.count, self.count)
        if self.whole:
            here = slice(self.last - count * self.rows, self.last)
            return self.choice.columns(self.recording, here, signals)
        # input and output are resampled by the same rule, so that its small errors cancel in the response
        values = self.choice.columns(self.recording, slice(self.first, self.last), signals)
        at = len(values) - 1 - (self.period / self.rows) * np.arange(count * self.rows)[::-1]
        spline = make_interp_spline(np.arange(len(values)), values, k=5)
        return np.asarray(spline(np.clip(at, 0, None)))


def whole_periods(recording: Recording, choice: Choice, period: float) -> Span:
    """Return the last whole periods of an experiment; the rows left over are at its beginning.

    Where a noise-free reference says when the excitation repeats, nothing before and behind that is used.

    Args:
        recording: one experiment.
        choice: its signals.
        period: in rows.

    Raises:
        InputError: fewer than two whole periods, or a masked or missing number in them.
    """
    rows = round(period)
    whole = rows > 0 and abs(period - rows) * (len(recording) / period) < _DRIFT
    first, last = 0, len(recording)
    if choice.reference is not None and whole and rows < len(recording):
        begin, end = periodic_rows(recording.signals[choice.reference][:, choice.place], rows)
        first, last = (begin, end) if end > begin else (first, last)
    count = int((last - first) / (rows if whole else period) * (1 + 1e-9)) if rows > 0 else 0
    if rows < 4 or count < 2:
        raise InputError(
            f"{counted(count, 'whole period')} of {period * recording.period:.6g} s in {recording.name}",
            file=recording.source, remedy="record two or more: workbench excite --periods",
        )  # fmt: skip
    length = count * rows if whole else min(int(np.ceil(count * period)) + 1, last - first)
    check_rows(recording, choice, last - length, last)
    return Span(recording, choice, period, rows, last - length, last, count)
