"""Where the error is: shares of the squared error above the noise by speed, position, frequency, time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from workbench.core import Recording, RecordingError, Share

from .score import scored_signals

_BINS = 8
_SMALLEST, _MOST = 0.02, 8  # share worth a line, and how many are


def locate(
    errors: Sequence[RecordingError], noisy: Sequence[Sequence[Recording]], units: Sequence[str]
) -> tuple[Share, ...]:
    """Return the intervals with most of the excess squared error of each axis and signal.

    Position and torque are each normalised by their noise, and what the noisy simulations leave in the
    same interval is subtracted, so that within one quantity shares add up to 1 over axes and signals.

    Args:
        errors: recordings with their simulations and noise.
        noisy: simulations with noise, one list per draw.
        units: ``rad`` or ``m`` per axis.
    """
    axes = errors[0].recording.axes
    edges = bands(max(1.0 / e.recording.period for e in errors))
    tables: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]] = {}
    for kind, signal in enumerate(("position", "torque")):
        for i, axis in enumerate(axes):
            draws = [[draw[k] for draw in noisy] for k in range(len(errors))]
            parts = [ResidualSeries.of(e, made, kind, i) for e, made in zip(errors, draws, strict=True)]
            parts = [p for p in parts if p is not None]
            if not parts:
                continue
            above = np.concatenate([p.above for p in parts])
            for quantity in ("speed", "position", "time"):
                values = np.concatenate([getattr(p, quantity) for p in parts])
                tables[axis, signal, quantity] = bins(values, above)
            tables[axis, signal, "frequency"] = (
                edges,
                sum((p.spectrum(edges) for p in parts), np.zeros(_BINS)),
            )
    return shares_of(tables, axes, units)


def shares_of(
    tables: Mapping[tuple[str, str, str], tuple[np.ndarray, np.ndarray]],
    axes: Sequence[str],
    units: Sequence[str],
) -> tuple[Share, ...]:
    """Return the largest shares from tables of edges and the excess between them, by axis, signal and
    quantity.
    """
    shares = []
    for chosen in ("speed", "position", "time", "frequency"):
        one = {key: table for key, table in tables.items() if key[2] == chosen}
        total = sum(float(np.maximum(excess, 0.0).sum()) for _, excess in one.values())
        for (axis, signal, quantity), (at, excess) in one.items():
            unit = units[list(axes).index(axis)]
            label = {"speed": f"{unit}/s", "position": unit, "time": "s", "frequency": "Hz"}[quantity]
            for k in np.flatnonzero(excess > _SMALLEST * total):
                between = float(at[k]), float(at[k + 1])
                shares.append(Share(axis, signal, quantity, between, label, float(excess[k] / total)))
    shares.sort(key=lambda s: -s.share)
    return tuple(shares[:_MOST])


class ResidualSeries:
    """One axis and signal of one recording: squared residual above the noise, row by row.

    `residual` (N,) and `wobbles` (draws, N) are in units of the noise's root mean square; `speed`,
    `position`, `time`, each (N,), say where a row lies.
    """

    def __init__(self, e: RecordingError, residual: np.ndarray, wobbles: np.ndarray, axis: int) -> None:
        valid = e.recording.valid
        self.residual, self.wobbles = residual, wobbles
        self.rate = 1.0 / e.recording.period
        self.speed = e.simulated.signals["velocity"][valid, axis]
        self.position = e.recording.position[valid, axis]
        self.time = e.recording.time[valid]
        self.above = residual**2 - np.mean(wobbles**2, axis=0)

    @staticmethod
    def of(e: RecordingError, noisy: Sequence[Recording], kind: int, axis: int) -> ResidualSeries | None:
        """Return the series; None if the signal was not measured or has no noise to compare with."""
        names = scored_signals(e.recording)
        if kind >= len(names):
            return None
        noise = (e.position_noise, e.torque_noise)[kind][axis]
        if not np.isfinite(noise) or noise <= 0:
            return None
        valid, name = e.recording.valid, names[kind]
        clean = e.simulated.signals[name][valid, axis]
        wobbles = np.stack([n.signals[name][valid, axis] - clean for n in noisy])
        return ResidualSeries(
            e, (e.recording.signals[name][valid, axis] - clean) / noise, wobbles / noise, axis
        )

    def spectrum(self, edges: np.ndarray) -> np.ndarray:
        """Return the squared residual above the noise in each frequency band, (bands,)."""
        noise = np.mean([self._power(w, edges) for w in self.wobbles], axis=0)
        return self._power(self.residual, edges) - noise

    def _power(self, values: np.ndarray, edges: np.ndarray) -> np.ndarray:
        f, density = scipy.signal.welch(values, fs=self.rate, nperseg=min(len(values), 4096), detrend=False)  # pyright: ignore[reportArgumentType]
        index = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, _BINS - 1)
        return np.bincount(index, weights=density * (f[1] - f[0]) * len(values), minlength=_BINS)


def bands(rate: float) -> np.ndarray:
    """Return edges of the frequency bands [Hz], from zero to half the row rate."""
    return np.concatenate([[0.0], np.geomspace(rate / 2000.0, rate / 2.0, _BINS)])


def bins(values: np.ndarray, excess: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return edges between intervals with equal numbers of rows, and the excess in each."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _BINS + 1)))
    if len(edges) < 2:
        return np.array([values[0], values[0]]), np.array([excess.sum()])
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    return edges, np.bincount(index, weights=excess, minlength=len(edges) - 1)
