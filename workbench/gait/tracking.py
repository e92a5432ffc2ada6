"""How far two runs of one command are apart: a bias, what is slow, and ripple within a stride."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bootstrap import Interval, resampled

SLOW_HZ = 1.0  # what changes more slowly than strides do
BLOCK_S = 1.0  # of the intervals; longer than a stride


@dataclass(frozen=True)
class Parts:
    """A difference of two signals in three parts (N,) that add up to it; their mean squares do too."""

    bias: np.ndarray
    slow: np.ndarray
    ripple: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """Return the difference (N,)."""
        return self.bias + self.slow + self.ripple


@dataclass(frozen=True)
class Tracking:
    """The paper's E_phi and E_RMSE (Eqs. 30 to 32), each of the whole gap and of its parts [%].

    Keys are ``whole``, ``bias``, ``slow`` and ``ripple``. Squares of the parts of E_RMSE of one speed add up;
    parts of E_phi are means of absolute values and add up to more than the whole.
    """

    phase: dict[str, Interval]
    rmse: dict[str, Interval]


def split(difference: np.ndarray, period: float) -> Parts:
    """Mean, what is below `SLOW_HZ`, and the rest, by Fourier's series of the stretch: orthogonal parts.

    Args:
        difference: (N,).
        period: of its rows [s].
    """
    bias = np.full_like(difference, difference.mean())
    spectrum = np.fft.rfft(difference - bias)
    spectrum[np.fft.rfftfreq(len(difference), period) >= SLOW_HZ] = 0.0
    slow = np.fft.irfft(spectrum, len(difference))
    return Parts(bias, slow, difference - bias - slow)


def tracking(one: np.ndarray, other: np.ndarray, command: np.ndarray, period: float) -> Tracking:
    """E_phi and E_RMSE of two runs, rows paired in time.

        E_phi = 100/c sum_k mean |d_k| / |u_k|,   E_RMSE = 100/c sum_k rms(d_k) / |u_k|

    E_phi averages over the rows, which at a steady speed is the average over the bins of the lap.

    Args:
        one, other: (N, c): forward speed, yaw rate, ...
        command: what both were asked for (c,); zeros are left out.
        period: of the rows [s].
    """
    rows = min(len(one), len(other))
    asked = np.flatnonzero(command)
    gap = (other[:rows] - one[:rows])[:, asked] / np.abs(command[asked])
    parts = [split(d, period) for d in gap.T]
    phase, rmse = {}, {}
    for name in ("whole", "bias", "slow", "ripple"):
        own = np.stack([getattr(p, name) for p in parts], axis=-1)
        if name == "bias":  # that of each block is not the whole's: its mean is
            sums = _by_block(gap, period)
            phase[name] = resampled(lambda m: 100.0 * np.abs(m).mean(axis=-1), sums)
            rmse[name] = phase[name]
            continue
        phase[name] = resampled(lambda m: 100.0 * m.mean(axis=-1), _by_block(np.abs(own), period))
        rmse[name] = resampled(lambda m: 100.0 * np.sqrt(m).mean(axis=-1), _by_block(own**2, period))
    return Tracking(phase, rmse)


def _by_block(values: np.ndarray, period: float) -> np.ndarray:
    """Means of blocks (B, c) of rows (N, c)."""
    count = max(1, round(len(values) * period / BLOCK_S))
    return np.stack([part.mean(axis=0) for part in np.array_split(values, count)])
