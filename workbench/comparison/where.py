"""Where the error sits: shares of the squared error above the noise by speed, position, frequency, time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import welch

from workbench.core import RecordingError, Share

from .score import scored_signals

_BINS = 8
_SPEEDS = "speed"


def locate(errors: Sequence[RecordingError], units: Sequence[str], keep: int = 8) -> tuple[Share, ...]:
    """The intervals that hold most of the excess squared error of each axis and signal.

    Shares are of all squared error above the noise, position and torque each normalised by its noise, so
    that they can be added up over axes and signals within one quantity.

    Args:
        errors: recordings with their simulations and noise.
        units: ``rad`` or ``m`` per axis.
        keep: number of shares to return, largest first.
    """
    axes = errors[0].recording.axes
    tables: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]] = {}
    total = 0.0
    for kind, name in enumerate(("position", "torque")):
        for i, axis in enumerate(axes):
            parts = [_series(e, kind, i) for e in errors]
            parts = [p for p in parts if p is not None]
            if not parts:
                continue
            residual2 = np.concatenate([p[0] ** 2 - 1.0 for p in parts])
            total += max(float(residual2.sum()), 0.0)
            for quantity, column in ((_SPEEDS, 1), ("position", 2), ("time", 3)):
                values = np.concatenate([p[column] for p in parts])
                tables[axis, name, quantity] = _bins(values, residual2)
            tables[axis, name, "frequency"] = _spectrum([(p[0], e) for p, e in zip(parts, errors, strict=False)])
    if total <= 0.0:
        return ()
    shares = []
    for (axis, name, quantity), (edges, excess) in tables.items():
        unit = units[list(axes).index(axis)]
        label = {_SPEEDS: f"{unit}/s", "position": unit, "time": "s", "frequency": "Hz"}[quantity]
        for k in np.flatnonzero(excess > 0.02 * total):
            shares.append(
                Share(axis, name, quantity, (float(edges[k]), float(edges[k + 1])), label, float(excess[k] / total))
            )
    # one line a quantity first, then the rest by size
    shares.sort(key=lambda s: -s.share)
    return tuple(shares[:keep])


def _series(e: RecordingError, kind: int, axis: int) -> tuple[np.ndarray, ...] | None:
    names = scored_signals(e.recording)
    if kind >= len(names):
        return None
    noise = (e.position_noise, e.torque_noise)[kind][axis]
    valid = e.recording.valid
    residual = (e.recording.signals[names[kind]] - e.simulated.signals[names[kind]])[valid, axis]
    if not np.isfinite(noise) or noise <= 0:
        return None
    speed = e.simulated.signals["velocity"][valid, axis]
    return residual / noise, speed, e.recording.position[valid, axis], e.recording.time[valid]


def _bins(values: np.ndarray, excess: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _BINS + 1)))
    if len(edges) < 2:
        return np.array([values[0], values[0]]), np.array([excess.sum()])
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    return edges, np.bincount(index, weights=excess, minlength=len(edges) - 1)


def _spectrum(parts: list[tuple[np.ndarray, RecordingError]]) -> tuple[np.ndarray, np.ndarray]:
    rate = 1.0 / parts[0][1].recording.period
    edges = np.concatenate([[0.0], np.geomspace(rate / 2000.0, rate / 2.0, _BINS)])
    excess = np.zeros(_BINS)
    for residual, _ in parts:
        length = min(len(residual), 4096)
        f, density = welch(residual, fs=rate, nperseg=length, detrend=False)
        power = density * (f[1] - f[0]) * len(residual)
        index = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, _BINS - 1)
        excess += np.bincount(index, weights=power, minlength=_BINS)
    # noise is taken as spread over the band; it is small where excess is worth naming
    excess -= np.diff(edges) / edges[-1] * sum(len(r) for r, _ in parts)
    return edges, np.maximum(excess, 0.0)
