"""Where the error is: shares of the squared error above the noise by speed, position, frequency, time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from workbench.core import Recording, RecordingError, Share

from .score import scored_signals

_BINS = 8
_SMALLEST, _MOST = 0.02, 8  # share worth a line, and how many are
_ROWS = "above", "speed", "position", "time"
_KINDS = "position", "torque"


@dataclass
class _Signal:
    """One axis and signal: rows that were kept, and power by frequency of all."""

    rows: dict[str, list[np.ndarray]] = field(default_factory=lambda: {name: [] for name in _ROWS})
    power: np.ndarray = field(default_factory=lambda: np.zeros(()))

    def column(self, name: str) -> np.ndarray:
        return np.concatenate(self.rows[name]).astype(float)


class Excess:
    """Squared residual above the noise of one source, collected stretch by stretch.

    Args:
        every: of so many rows one is kept; a prime at least as large, so that it goes with no tick.
        rate: of the rows that say where the frequency bands end [Hz]; default: those that are added.
    """

    def __init__(self, every: int = 1, rate: float | None = None) -> None:
        self._every = next(
            k for k in range(every, 2 * every + 2) if k == 1 or all(k % d for d in range(2, k))
        )
        self._signals: dict[tuple[int, int], _Signal] = {}
        self._edges = None if rate is None else _bands(rate)

    def add(self, recording: Recording, clean: Recording, noisy: Sequence[Recording], start: float) -> None:
        """Add a stretch that begins at `start` [s], with its runs."""
        self._edges = _bands(1.0 / recording.period) if self._edges is None else self._edges
        valid = recording.valid
        for kind, name in enumerate(scored_signals(recording)):
            for i in range(len(recording.axes)):
                expected = clean.signals[name][valid, i]
                residual = recording.signals[name][valid, i] - expected
                wobbles = np.stack([n.signals[name][valid, i] - expected for n in noisy])  # (draws, N)
                rows = {
                    "above": residual**2 - np.mean(wobbles**2, axis=0),
                    "speed": clean.signals["velocity"][valid, i],
                    "position": recording.position[valid, i],
                    "time": recording.time[valid] + start,
                }
                own = self._signals.setdefault((kind, i), _Signal())
                for row, values in rows.items():
                    kept = values[:: self._every]
                    own.rows[row].append(kept if self._every == 1 else kept.astype(np.float32))
                powers = [_power(w, recording.period, self._edges) for w in wobbles]
                own.power = (
                    own.power + _power(residual, recording.period, self._edges) - np.mean(powers, axis=0)
                )

    @staticmethod
    def located(
        sources: Sequence[Excess], entries: Sequence[RecordingError], units: Sequence[str]
    ) -> tuple[Share, ...]:
        """Return the intervals with most of the excess squared error of each axis and signal.

        Position and torque are each normalised by their noise, and what the noisy simulations leave in the
        same interval is subtracted, so that within one quantity shares add up to 1 over axes and signals.

        Args:
            sources: the excess of each recording.
            entries: the recordings with their noise.
            units: ``rad`` or ``m`` per axis.
        """
        axes = entries[0].recording.axes
        tables: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]] = {}
        for key in sorted({k for s in sources for k in s._signals}):
            kind, i = key
            parts = []
            for source, e in zip(sources, entries, strict=True):
                noise = float((e.position_noise, e.torque_noise)[kind][i])
                if key in source._signals and np.isfinite(noise) and noise > 0:
                    parts.append((source, source._signals[key], noise**-2))
            if not parts:
                continue
            name = axes[i], _KINDS[kind]
            # rows stand for as many as were left out
            above = np.concatenate([p._every * weight * own.column("above") for p, own, weight in parts])
            for quantity in _ROWS[1:]:
                values = np.concatenate([own.column(quantity) for _, own, _ in parts])
                tables[*name, quantity] = _bins(values, above)
            edges = max((p._edges for p, _, _ in parts if p._edges is not None), key=lambda e: e[-1])
            tables[*name, "frequency"] = (
                edges,
                np.sum([weight * own.power for _, own, weight in parts], axis=0),
            )
        return _largest(tables, axes, units)


def _largest(
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


def _power(values: np.ndarray, period: float, edges: np.ndarray) -> np.ndarray:
    """Return the sum of squares of rows `period` [s] apart in each frequency band, (bands,)."""
    f, density = scipy.signal.welch(values, fs=1.0 / period, nperseg=min(len(values), 4096), detrend=False)  # pyright: ignore[reportArgumentType]
    index = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, _BINS - 1)
    return np.bincount(index, weights=density * (f[1] - f[0]) * len(values), minlength=_BINS)


def _bands(rate: float) -> np.ndarray:
    """Return edges of the frequency bands [Hz], from zero to half the row rate."""
    return np.concatenate([[0.0], np.geomspace(rate / 2000.0, rate / 2.0, _BINS)])


def _bins(values: np.ndarray, excess: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return edges between intervals with equal numbers of rows, and the excess in each."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _BINS + 1)))
    if len(edges) < 2:
        return np.array([values[0], values[0]]), np.array([excess.sum()])
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    return edges, np.bincount(index, weights=excess, minlength=len(edges) - 1)
