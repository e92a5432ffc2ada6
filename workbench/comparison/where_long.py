"""Where the error of a long log is: from a part of its rows and the spectra of all its stretches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from workbench.core import Recording, RecordingError, Share

from .where import ResidualSeries, bands, bins, shares_of

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
    """

    def __init__(self, every: int) -> None:
        self._every = next(
            k for k in range(every, 2 * every + 2) if k == 1 or all(k % d for d in range(2, k))
        )
        self._signals: dict[tuple[int, int], _Signal] = {}
        self._axes: tuple[str, ...] = ()
        self._rate = 1.0

    def add(self, recording: Recording, clean: Recording, noisy: Sequence[Recording], start: float) -> None:
        """Add a stretch that begins at `start` [s], with its runs."""
        n = len(recording.axes)
        self._axes, self._rate = recording.axes, 1.0 / recording.period
        # in units of one: the noise is known when all is through
        one = np.ones(n)
        entry = RecordingError(recording, clean, one, one, one, one, 1.0, 1.0)
        for kind in range(2):
            for i in range(n):
                series = ResidualSeries.of(entry, noisy, kind, i)
                if series is None:
                    continue
                own = self._signals.setdefault((kind, i), _Signal())
                for name in _ROWS:
                    values = getattr(series, name)[:: self._every] + (start if name == "time" else 0.0)
                    own.rows[name].append(values.astype(np.float32))
                own.power = own.power + series.spectrum(self._edges)

    @cached_property
    def _edges(self) -> np.ndarray:
        return bands(self._rate)

    @staticmethod
    def together(sources: Sequence[Excess], entries: Sequence[RecordingError]) -> Located:
        """Return the excess of all sources, in units of the noise."""
        tables: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]] = {}
        for key in sorted({k for s in sources for k in s._signals}):
            kind, i = key
            parts, weights = [], []
            for source, e in zip(sources, entries, strict=True):
                noise = float((e.position_noise, e.torque_noise)[kind][i])
                if key in source._signals and np.isfinite(noise) and noise > 0:
                    parts.append(source)
                    weights.append(noise**-2)
            if not parts:
                continue
            name = parts[0]._axes[i], _KINDS[kind]
            own = [p._signals[key] for p in parts]
            # rows stand for as many as were left out
            above = np.concatenate(
                [p._every * w * x.column("above") for p, w, x in zip(parts, weights, own, strict=True)]
            )
            for quantity in _ROWS[1:]:
                values = np.concatenate([x.column(quantity) for x in own])
                tables[*name, quantity] = bins(values, above)
            edges = max((p._edges for p in parts), key=lambda e: e[-1])
            power = [w * x.power for w, x in zip(weights, own, strict=True)]
            tables[*name, "frequency"] = edges, np.sum(power, axis=0)
        return Located(tables, sources[0]._axes)


@dataclass(frozen=True)
class Located:
    """Intervals and the excess in each, by axis, signal and quantity."""

    tables: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]]
    axes: tuple[str, ...]

    def shares(self, units: Sequence[str]) -> tuple[Share, ...]:
        """Return the largest shares."""
        return shares_of(self.tables, self.axes, units)
