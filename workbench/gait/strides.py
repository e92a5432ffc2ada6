"""Strides of a periodic motion, seen in one joint; and how long feet stand in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bootstrap import Interval, resampled

SLOWEST, FASTEST = 0.4, 12.0  # Hz
_ALIKE = 0.3  # correlation of a stride with the next, below which there are none
_NEAR_BEST = 0.85  # of the best correlation: the shortest such time is one stride, not two
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
    lag = peaks[alike[peaks] >= _NEAR_BEST * alike[peaks].max()][0]
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
