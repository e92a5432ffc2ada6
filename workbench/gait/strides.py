"""Strides of a periodic motion, seen in one joint; and how long feet stand in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .bootstrap import Interval, resampled

SLOWEST, FASTEST = 0.4, 12.0  # Hz
_ALIKE = 0.3  # correlation of a stride with the next, below which there are none
_NEAR_BEST = 0.85  # of the best correlation: the shortest such time is one stride, not two
_PERHAPS, _SURELY = (
    0.7,
    0.95,
)  # of the best: the shortest time that may be a stride, and one that is none of two
_OTHER_COUNT = 0.35  # of a logarithm, half an octave: runs counted in another way are an octave apart
_BAND = 0.5  # of the stride's frequency: width of what counts as the same motion


@dataclass(frozen=True)
class Strides:
    """Where strides begin: rows, with fractions, (S + 1,); and the rows' period [s]."""

    starts: np.ndarray
    period: float

    @property
    def seconds(self) -> np.ndarray:
        """Return how long each stride took (S,) [s]."""
        return np.diff(self.starts) * self.period

    @property
    def frequency(self) -> Interval:
        """Strides a second [Hz]."""
        return resampled(lambda m: 1.0 / m[..., 0], self.seconds[:, None])


def strides_of(signal: np.ndarray, period: float) -> Strides | None:
    """Strides of a joint that swings to and fro; None where none are seen.

    The stride's time is the shortest after which the signal is like itself; strides begin where the signal's
    part near that frequency rises through its mean.

    Args:
        signal: of one joint (N,).
        period: of the rows [s].
    """
    return None if (lags := _lags(signal, period)) is None else _strides(signal, period, lags[0])


def strides_alike(signals: Sequence[np.ndarray], period: float) -> list[Strides | None]:
    """Strides of runs that are compared, counted alike.

    Steps that differ in turn are nearly alike after one stride, and alike after two. Little decides which of
    both is a stride, and it has to be the same in all runs: else one has half of the other's frequency.

    Args:
        signals: of one joint in each run (N,); the first says what a stride is, where that fits the others.
        period: of the rows [s].
    """
    seen = [_lags(signal, period) for signal in signals]
    if (first := seen[0]) is None:
        return [strides_of(signal, period) for signal in signals]
    others = [lags for lags in seen[1:] if lags is not None]
    apart = [sum(min(_apart(lag, own) for lag in lags) for lags in others) for own in first]
    own = first[0] if apart[0] <= min(apart) + _OTHER_COUNT else first[int(np.argmin(apart))]
    return [
        None if lags is None else _strides(x, period, _counted_like(own, lags))
        for x, lags in zip(signals, seen, strict=True)
    ]


def _counted_like(own: int, lags: list[int]) -> int:
    """The most likely number of rows, or the one nearest to another run's where that is nearer by far."""
    nearest = min(lags, key=lambda lag: _apart(lag, own))
    return lags[0] if _apart(lags[0], own) <= _apart(nearest, own) + _OTHER_COUNT else nearest


def _apart(one: int, other: int) -> float:
    return abs(float(np.log(one / other)))


def _lags(signal: np.ndarray, period: float) -> list[int] | None:
    """How many rows a stride may last: first the most likely number; None where none are seen."""
    x = signal - signal.mean()
    n = len(x)
    longest = min(n // 2, int(1.0 / (SLOWEST * period)))
    shortest = max(2, int(1.0 / (FASTEST * period)))
    if longest <= shortest + 2 or not x.any():
        return None
    power = np.abs(np.fft.rfft(x, 2 * n)) ** 2
    energy = np.concatenate([[0.0], np.cumsum(x**2)])
    lags = np.arange(longest + 1)
    overlap = np.sqrt((energy[n] - energy[lags]) * energy[n - lags])
    alike = np.fft.irfft(power)[: longest + 1] / np.maximum(overlap, 1e-300)
    inner = alike[1:-1]
    peaks = 1 + np.flatnonzero((inner >= alike[:-2]) & (inner > alike[2:]))
    peaks = peaks[peaks >= shortest]
    if not len(peaks) or alike[peaks].max() < _ALIKE:
        return None
    share = alike[peaks] / alike[peaks].max()
    sure = int(np.argmax(share >= _SURELY))
    own = int(peaks[share >= _NEAR_BEST][0])
    return [own, *(int(k) for k in peaks[: sure + 1][share[: sure + 1] >= _PERHAPS] if k != own)]


def _strides(signal: np.ndarray, period: float, lag: int) -> Strides | None:
    x = signal - signal.mean()
    n = len(x)
    frequency = np.fft.rfftfreq(n, period)
    own = 1.0 / (lag * period)
    near = np.exp(-0.5 * ((frequency - own) / (0.5 * _BAND * own)) ** 2)
    smooth = np.fft.irfft(np.fft.rfft(x) * near, n)
    rows = np.flatnonzero((smooth[:-1] < 0.0) & (smooth[1:] >= 0.0))
    starts = rows + smooth[rows] / (smooth[rows] - smooth[rows + 1])
    starts = starts[1:-1]  # Fourier's series joins both ends, which bends the first and the last
    return Strides(starts, period) if len(starts) > 1 else None


def duty_factor(loaded: np.ndarray, strides: Strides) -> Interval:
    """Share of a stride for which a foot stands, mean over the feet.

    Args:
        loaded: whether each foot carries load, (N, F) bool.
        strides: of the same rows.
    """
    total = np.concatenate([[0.0], np.cumsum(loaded.mean(axis=1))])
    at = np.interp(strides.starts, np.arange(len(total)), total)
    share = np.stack([np.diff(at), np.diff(strides.starts)], axis=1)
    return resampled(lambda m: m[..., 0] / m[..., 1], share)
