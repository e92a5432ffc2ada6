"""The mean cycle of a signal over the stride's phase, and how far those of two recordings are apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bootstrap import Interval, resampled
from .strides import Strides

PHASES = 50  # points a stride


@dataclass(frozen=True)
class Cycles:
    """A signal stride by stride, (S, PHASES, c)."""

    values: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        """Return the mean stride (PHASES, c)."""
        return self.values.mean(axis=0)


def cycles_of(signal: np.ndarray, strides: Strides) -> Cycles:
    """Return a signal (N, c) cut into strides and put on their phase."""
    share = np.arange(PHASES) / PHASES
    at = strides.starts[:-1, None] + share * np.diff(strides.starts)[:, None]
    rows = np.arange(len(signal))
    return Cycles(np.stack([np.interp(at, rows, column) for column in signal.T], axis=-1))


def cycle_gap(one: Cycles, other: Cycles) -> Interval:
    """Root mean square over phase and channels of the difference of two mean strides, in the signal's unit.

    Strides that scatter leave a gap too: that of the hardware's own second run is the floor.
    """
    first, second = (c.values.reshape(len(c.values), -1) for c in (one, other))
    return resampled(lambda a, b: np.sqrt(np.mean(np.square(b - a), axis=-1)), first, second)
