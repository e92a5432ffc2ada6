"""How long one period of a periodic excitation is, and which rows of a recording repeat it."""

from __future__ import annotations

import numpy as np

_ALIKE = 0.9  # a period repeats at least this much of the signal
_LESS = 0.03  # noise and the rounding to rows may make a true period this much less alike than the best

#: Parts of a reference's size by which it may fail to repeat: written and read, or resampled from a clock
#: that jitters.
_TOLERANCES = (1e-6, 0.1)


def find_period(signal: np.ndarray) -> float | None:
    """Return the period of a signal by its autocorrelation; None if it does not repeat.

    The smallest lag is taken at which the signal is as similar to itself as it is anywhere, refined at the
    largest multiple that fits, so that the error is a small part of a row.

    Args:
        signal: shape (N,) or (N, n); columns share one period.

    Returns:
        Period in rows; None where nothing repeats at least once in the signal.
    """
    columns = np.asarray(signal, float).reshape(len(signal), -1)
    columns = columns - columns.mean(axis=0)
    rows = len(columns)
    if rows < 8 or not np.any(columns):
        return None
    spread = columns.std(axis=0)
    columns = columns[:, spread > 0] / spread[spread > 0]
    similar = _autocorrelation(columns)
    longest = rows // 2
    # beyond the lobe at lag 0, in which every smooth signal is similar to itself
    below = np.flatnonzero(similar[:longest] < 0.5)
    if len(below) == 0:
        return None
    first = int(below[0])
    height = _heights(similar[: longest + 2])
    best = height[first : longest + 1].max()
    if best < _ALIKE:
        return None
    good = height > best - _LESS
    if similar[first : longest + 1].max() > 1 - 1e-9:
        # without noise, a lag of whole rows that is not exact is no period, however close it comes
        good &= (np.abs(_off_rows(similar[: longest + 2])) > 0.1) | (similar[: longest + 2] > 1 - 1e-7)
    return _refined(similar, first + int(np.argmax(good[first : longest + 1])), longest)


def periodic_rows(reference: np.ndarray, period: int) -> tuple[int, int]:
    """Return the longest stretch of rows over which a noise-free reference repeats itself.

    Before it lies a fade-in or a rest, behind it whatever came when the excitation had ended.

    Args:
        reference: shape (N, r).
        period: in rows.

    Returns:
        ``(first, last)``: rows first to last - 1 repeat; empty where none do for two periods.
    """
    for tolerance in _TOLERANCES:
        first, last = _longest_stretch(reference, period, tolerance)
        if last - first >= 2 * period:
            return first, last
    return 0, 0


def _longest_stretch(reference: np.ndarray, period: int, tolerance: float) -> tuple[int, int]:
    scale = np.abs(reference - reference.mean(axis=0)).max()
    alike = np.all(np.abs(reference[period:] - reference[:-period]) <= tolerance * scale, axis=1)
    # a reference that has stopped repeats too
    active = np.cumsum(np.concatenate([[0.0], np.any(np.diff(reference, axis=0) != 0, axis=1)]))
    alike &= active[period:] - active[:-period] > 0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], alike, [False]]).astype(int)))
    if len(edges) == 0:
        return 0, 0
    first, last = edges.reshape(-1, 2)[np.argmax(np.diff(edges)[::2])]
    end = int(last) + period
    # a last row that equals the rest behind it may be that rest already
    while first < end < len(reference) and np.array_equal(reference[end - 1], reference[end]):
        end -= 1
    return int(first), end


def _autocorrelation(columns: np.ndarray) -> np.ndarray:
    """Return a signal's correlation with itself by lag, mean of columns; each lag over its own rows."""
    rows = len(columns)
    size = 2 ** int(np.ceil(np.log2(2 * rows)))
    power = np.abs(np.fft.rfft(columns, size, axis=0)) ** 2
    raw = np.fft.irfft(power.mean(axis=1), size)[:rows]
    # energy of the rows that overlap at each lag, of both copies: a fade-in does not count as difference
    energy = np.cumsum(np.mean(columns**2, axis=1))
    total = energy[-1]
    lag = np.arange(rows)
    head = energy[rows - 1 - lag]
    tail = total - np.concatenate([[0.0], energy[: rows - 1]])
    return raw / np.maximum(np.sqrt(head * tail), 1e-12 * total)


def _heights(similar: np.ndarray) -> np.ndarray:
    """Return the heights of peaks between rows, by parabolas, at their nearest row; zero elsewhere."""
    low, middle, high = similar[:-2], similar[1:-1], similar[2:]
    top = (middle >= low) & (middle >= high) & (low + high < 2 * middle)
    out = np.zeros_like(similar)
    out[1:-1] = np.where(top, middle - 0.25 * (low - high) * _off_rows(similar)[1:-1], 0.0)
    return out


def _off_rows(similar: np.ndarray) -> np.ndarray:
    """Return how far each peak lies from its nearest row, in rows; zero where there is no peak."""
    out = np.zeros_like(similar)
    low, middle, high = similar[:-2], similar[1:-1], similar[2:]
    bend = low - 2 * middle + high
    out[1:-1] = np.where(bend < 0, 0.5 * (low - high) / np.where(bend < 0, bend, 1.0), 0.0)
    return out


def _refined(similar: np.ndarray, lag: int, longest: int) -> float:
    """Return the peak between rows by a parabola, at ever larger multiples of the period."""
    period = float(lag)
    multiple = 1
    while True:
        centre = round(period * multiple)
        if centre + 1 > longest:
            return period
        low, middle, high = similar[centre - 1 : centre + 2]
        bend = low - 2 * middle + high
        period = (centre + (0.5 * (low - high) / bend if bend < 0 else 0.0)) / multiple
        multiple *= 2
