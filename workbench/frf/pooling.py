"""Covariances pooled over neighbouring lines, where a single line has too few residuals.

Noise is smooth along frequency, but may be steep: what noise does to a machine in its loop piles up at low
frequency. So the level is followed by straight lines in log-log, and only what is left after dividing by it,
correlations and scatter, is averaged over many lines.
"""

from __future__ import annotations

import numpy as np

_WIDE = 0.25  # the level is fitted over at least this part of the frequency to each side...
_LEVEL = 16.0  # ...and over lines with this many residuals
#: Errors of the level that neighbours share cancel when the average is scaled back; this part of the level's
#: variance stays (by simulation, 2 to 6 periods).
_STAYS = 0.25


def pooled_covariance(
    covariance: np.ndarray, dof: np.ndarray, fresh: np.ndarray, frequency: np.ndarray, lines: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return covariances averaged over `lines` lines to each side, and the residuals behind each.

    Args:
        covariance: (F, m, m), of something whose level varies smoothly.
        dof: complex residuals behind each, (F,).
        fresh: of these, not shared with the line before, (F,).
        frequency: [Hz], (F,).
        lines: to each side.

    Returns:
        ``(covariance, dof)``; the residuals count both the average's and the level's uncertainty.
    """
    m = covariance.shape[1]
    total = dof + _sums(fresh, lines) - fresh
    power = np.einsum("fii->f", covariance).real / m
    if len(power) < 4 or not (power > 0).all():
        weight = _sums(dof, lines)
        return _sums(dof[:, None, None] * covariance, lines) / weight[:, None, None], total
    level, leverage = _level(np.log(power), np.log(frequency), fresh * m)
    shape = covariance / level[:, None, None]
    mean = _sums(dof[:, None, None] * shape, lines) / _sums(dof, lines)[:, None, None]
    return mean * level[:, None, None], 1.0 / (1.0 / total + _STAYS * leverage / (fresh * m))


def _level(log_power: np.ndarray, x: np.ndarray, residuals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the level of each line by local lines in log-log, (F,), and each line's own weight, (F,)."""
    count = len(x)
    rows = np.arange(count)
    least = int(np.ceil(0.5 * _LEVEL / max(float(np.min(residuals)), 1e-9)))
    low = np.minimum(np.searchsorted(x, x + np.log(1 - _WIDE)), rows - max(least, 2))
    high = np.maximum(np.searchsorted(x, x + np.log(1 + _WIDE)), rows + max(least, 2) + 1)
    low, high = np.maximum(low, 0), np.minimum(high, count)
    x0 = x - x.mean()

    def sums(values: np.ndarray) -> np.ndarray:
        total = np.concatenate([[0.0], np.cumsum(values)])
        return total[high] - total[low]

    n = (high - low).astype(float)
    mean_x, mean_y = sums(x0) / n, sums(log_power) / n
    spread = np.maximum(sums(x0**2) / n - mean_x**2, 1e-12)
    slope = (sums(x0 * log_power) / n - mean_x * mean_y) / spread
    away = x0 - mean_x
    return np.exp(mean_y + slope * away), np.minimum((1 + away**2 / spread) / n, 1.0)


def _sums(values: np.ndarray, lines: int) -> np.ndarray:
    """Return sums over `lines` rows to each side, fewer at the ends."""
    total = np.concatenate([np.zeros_like(values[:1]), np.cumsum(values, axis=0)])
    rows = np.arange(len(values))
    return total[np.minimum(rows + lines + 1, len(values))] - total[np.maximum(rows - lines, 0)]
