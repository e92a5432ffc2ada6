"""A first pass through recordings and logs: scales of the signals, and a sample of stretches."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from workbench.core import Recording
from workbench.models import Model
from workbench.recordings import Log, Stretch, check_moves
from workbench.simulation import check_axes, scored_torque

from .score import Scale, follows_motion

SAMPLED = 6  # stretches of a log; sensors say in any how noisy they are


class Survey:
    """Pooled standard deviations of every signal, and a sample of stretches.

    Attributes:
        sample: recordings, and of each log some stretches, spread over it.
        rows: valid ones, a source.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.sample: list[Recording] = []
        self.rows: list[int] = []
        self._moments: list[tuple[bool, _Moments, _Moments]] = []

    def add(self, source: Recording | Log, pieces: Iterator[Stretch]) -> None:
        """Add one source.

        Raises:
            InputError: other axes than the model's; a log that cannot be read, or an axis that never moves.
        """
        position, torque, rows = _Moments(), _Moments(), 0
        limits: dict[str, np.ndarray] = {}
        chosen: list[Recording] = []
        wanted = 1
        for k, piece in enumerate(pieces):
            r = piece.recording
            if k == 0:
                check_axes(r, self.model)
            counted = r.valid & (np.arange(len(r)) >= piece.lead)
            rows += int(counted.sum())
            position.add(r.position[counted])
            name = scored_torque(r)
            if name is not None:
                torque.add(r.signals[name][counted])
            for signal, values in r.signals.items():
                both = np.stack([values.min(axis=0), values.max(axis=0)])
                old = limits.get(signal, both)
                limits[signal] = np.stack([np.minimum(old[0], both[0]), np.maximum(old[1], both[1])])
            # every one at first; each time there are too many, every other one goes
            if k % wanted == 0 and counted.any():
                chosen.append(r)
            if len(chosen) > 2 * SAMPLED:
                chosen, wanted = chosen[::2], 2 * wanted
        if isinstance(source, Log):
            check_moves(source, limits)
        self.sample += chosen
        self.rows.append(rows)
        self._moments.append((follows_motion(chosen[0]), position, torque))

    def scale(self, replayed: tuple[Recording, ...]) -> Scale:
        """Return the standard deviations of scored signals, pooled over all rows of all sources."""
        along = any(follows_motion(r) for r in replayed)
        n = self.model.size
        position = _Moments.together([p for own, p, _ in self._moments if not (along or own)])
        torque = _Moments.together([t for *_, t in self._moments])
        return Scale(position.std(n), torque.std(n))


class _Moments:
    """Count, mean and squared deviations, joined as by Chan, Golub and LeVeque (1983), eq. (2.1)."""

    def __init__(self) -> None:
        self.count, self.mean, self.square = 0, np.zeros(()), np.zeros(())
        self.low, self.high = np.array(np.inf), np.array(-np.inf)

    def add(self, values: np.ndarray) -> None:
        """Rows (K, n)."""
        if len(values):
            own = _Moments()
            own.count, own.mean = len(values), values.mean(axis=0)
            own.square = np.sum((values - own.mean) ** 2, axis=0)
            own.low, own.high = values.min(axis=0), values.max(axis=0)
            self._join(own)

    def _join(self, other: _Moments) -> None:
        if not other.count:
            return
        whole, away = self.count + other.count, other.mean - self.mean
        self.square = self.square + other.square + away**2 * self.count * other.count / whole
        self.mean, self.count = self.mean + away * other.count / whole, whole
        self.low, self.high = np.minimum(self.low, other.low), np.maximum(self.high, other.high)

    @staticmethod
    def together(parts: list[_Moments]) -> _Moments:
        """All of them."""
        out = _Moments()
        for part in parts:
            out._join(part)
        return out

    def std(self, n: int) -> np.ndarray:
        """Standard deviation (n,); NaN of what never moves, or was never there."""
        if not self.count:
            return np.full(n, np.nan)
        return np.where(self.high > self.low, np.sqrt(self.square / self.count), np.nan)
