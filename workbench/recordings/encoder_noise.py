"""Noise of encoders: rounding and white noise; motion that looks like noise is neither."""

from __future__ import annotations

import numpy as np

from .white_noise import BANDS, WINDOW, WINDOWS, white_noise

_PLAIN = 2.0  # times the rounding from which the rest is noise for certain: motion seldom leaves so much
_CHANCE = 3.0  # deviations by which powers differ for certain


def position_noise(positions: np.ndarray, valid: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return the standard deviation (n,) of position noise including rounding; NaN where nothing moves.

    Rounding alone leaves white noise of its own size. A hard-driven axis leaves motion beside it, which is no
    noise: it falls off from band to band, where noise stays. Of an axis on which that cannot be told the
    other axes with the same encoder say how noisy it is.

    Args:
        positions: shape (N, n).
        valid: rows to trust, shape (N,) bool.
        steps: of the encoders, (n,): 0 without one, NaN where nothing moves.
    """
    rounding = steps / np.sqrt(12.0)
    moves = ~np.isnan(steps)
    white = np.full(len(steps), np.nan)
    white[moves] = [white_noise(q, valid) for q in positions.T[moves]]
    sure = white >= _PLAIN * rounding
    between = ~sure & (white > rounding)
    told = sure.copy()
    told[between] = [_stays(positions[:, i], valid, rounding[i]) for i in np.flatnonzero(between)]
    out = np.where(told, white, rounding)
    for i in np.flatnonzero(between & ~told):
        alike = np.isclose(steps, steps[i], rtol=1e-6)
        if 2 * (told & alike).sum() > alike.sum():
            out[i] = min(white[i], float(np.median(out[told & alike])))
    return out


def _stays(signal: np.ndarray, valid: np.ndarray, rounding: float) -> bool:
    """Return whether a signal's residual (N,) exceeds rounding and, like noise, shrinks no further.

    What motion adds falls by about one factor from band to band, from which follows how much of it is in the
    last one still.
    """
    power = np.array([white_noise(signal, valid, bands=(band,)) ** 2 for band in BANDS])
    rows = WINDOW * min(WINDOWS, max(len(signal) // WINDOW, 1)) * (1.0 - BANDS[-1])
    chance = _CHANCE * np.sqrt(np.pi / rows)  # relative, of a power by the median of windows
    first, second = power[0] - power[1], power[1] - power[2]
    motion = abs(second)
    if first > second > 0.0:
        motion = min(motion, second**2 / (first - second))
    # rounding of a slow motion is not quite white, and a little more than its own size says nothing
    more = np.sqrt(power[2]) > (1.0 + 2.0 * chance) * rounding
    return bool(more and motion <= chance * power[2])
