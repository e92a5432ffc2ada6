"""Data of a diagnosis: recordings for training and test, noise floor, folds, weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from workbench.comparison import Replay, Scale, Simulated, followed, normalised, replay_of, scored_signals
from workbench.core import Recording
from workbench.models import Model

from .motion_period import motion_period
from .policy import POLICY
from .work_budget import WorkBudget

_BLOCKS = 5  # contiguous folds of a lone recording; a recording of half of all rows has half as many
_NOISY = 6  # runs of each recording that a noise floor takes


@dataclass(frozen=True)
class Fold:
    """A piece of the training data: rows of one recording."""

    recording: int
    rows: slice | np.ndarray


@dataclass(frozen=True)
class Data:
    """Recordings (training first, then held out), their noise floor, and the weights of residuals.

    Attributes:
        recordings: all of them.
        training: number of those used for fitting.
        replay: how models are run on them.
        floor: mean squares that a perfect model leaves, per recording, (R, 2, n): position, torque.
        immaterial: mean squares by which two right simulations may differ, (R, 2, n).
        draws: noisy minus noise-free runs that `floor` is the mean of, per draw and recording,
            (N, 2, n) each; used for the scatter of estimates.
        weight: one over the deviation that residuals are divided by, (2, n); 0 for absent signals.
        holdout_uninformative: whether the held-out error is at the noise from the start, so that
            cross-validation on folds takes its place.
        budget: work done so far and its limit, one count for all data of a search.
        motion_periods: rows after which the motion of each recording repeats itself, None where it does not.
    """

    recordings: tuple[Recording, ...]
    training: int
    replay: Replay
    floor: np.ndarray
    immaterial: np.ndarray
    draws: tuple[tuple[np.ndarray, ...], ...]
    weight: np.ndarray
    holdout_uninformative: bool = False
    budget: WorkBudget = field(default_factory=WorkBudget)
    motion_periods: tuple[int | None, ...] = ()

    @property
    def held_out(self) -> bool:
        """Return whether there are held-out recordings."""
        return self.training < len(self.recordings)

    @property
    def tests_on_holdout(self) -> bool:
        """Whether the test loss comes from held-out recordings; otherwise it is cross-validated on folds."""
        return self.held_out and not self.holdout_uninformative

    def weighed_for(self, mean_squares: np.ndarray) -> Data:
        """Return the same data weighted for a model that leaves these mean squares, (R, 2, n).

        Tested on held-out recordings only if the error there exceeds the noise.
        """
        out = self.reweighed(mean_squares)
        if not self.held_out:
            return out
        error, floor = (out.objective(out.pool(ms, held_out=True)) for ms in (mean_squares, out.floor))
        return replace(out, holdout_uninformative=error < POLICY.holdout_informative * floor)

    def cross_validated(self) -> Data:
        """Return the same data, cross-validated on folds of the training recordings."""
        return replace(self, holdout_uninformative=True)

    @property
    def noise_squares(self) -> np.ndarray:
        """Return mean squares that noise alone leaves, of each draw and recording, (N, R, 2, n)."""
        return np.array([[np.mean(x**2, axis=0) for x in draw] for draw in self.draws])

    @property
    def folds(self) -> tuple[Fold, ...]:
        """Return the folds: training recordings, of which the long ones are split into contiguous blocks.

        What only one long recording shows is tested on another part of it.
        """
        rows = [len(r) for r in self.recordings[: self.training]]
        out: list[Fold] = []
        for i, length in enumerate(rows):
            blocks = max(1, round(_BLOCKS * length / sum(rows)))
            edges = np.linspace(0, length, blocks + 1).astype(int)
            out += [Fold(i, slice(a, b)) for a, b in pairwise(edges)]
        return tuple(out)

    @property
    def phase_folds(self) -> tuple[Fold, ...]:
        """Return the folds; those of a periodic motion are split by phase, so that none copies another."""
        out: list[Fold] = []
        for i, period in enumerate(self.motion_periods[: self.training]):
            own = [f for f in self.folds if f.recording == i]
            if period and len(own) > 1:
                phase = np.arange(len(self.recordings[i])) % period * len(own) // period
                own = [Fold(i, np.flatnonzero(phase == k)) for k in range(len(own))]
            out += own
        return tuple(out) or self.folds

    def part(self, chosen: Sequence[int]) -> Data:
        """Return only these training recordings, without held-out ones and with the same weights."""
        return replace(
            self,
            recordings=tuple(self.recordings[i] for i in chosen),
            training=len(chosen),
            replay=self.replay.only(chosen),
            floor=self.floor[list(chosen)],
            immaterial=self.immaterial[list(chosen)],
            draws=tuple(tuple(draw[i] for i in chosen) for draw in self.draws),
            motion_periods=tuple(self.motion_periods[i] for i in chosen if self.motion_periods),
        )

    def most_informative(self, mean_squares: np.ndarray, share: float) -> tuple[int, ...]:
        """Indices of the fewest training recordings that contain this share of the error above the noise."""
        counts = np.array([np.sum(r.valid) for r in self.recordings[: self.training]])
        above = np.maximum(mean_squares - self.floor, 0.0)[: self.training]
        excess = counts * np.sum(above * self.weight**2, axis=(1, 2))
        order = np.argsort(-excess)
        enough = np.searchsorted(np.cumsum(excess[order]), share * excess.sum()) + 1
        return tuple(sorted(int(i) for i in order[:enough]))

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Simulate with `Replay.run`, and count the work."""
        self.budget.add(self.recordings[:first], len(models))
        return self.replay.run(models, first)

    def of_model(self, model: Model, seed: int) -> tuple[Data, Simulated]:
        """Return the same recordings with the noise floor of a model's own runs, and those runs.

        Raises:
            SimulationError: the model is unstable in a recording's loop.
        """
        self.budget.add(self.recordings, _NOISY)
        simulated = self.replay.with_noise(model, seed)
        return replace(self, holdout_uninformative=False, **_floor(self.recordings, simulated)), simulated

    def residual(self, index: int, simulated: Recording) -> np.ndarray:
        """Measured minus simulated values, (N, 2, n), unweighted; zero where not measured or masked."""
        measured = self.recordings[index]
        out = difference(measured, simulated, measured)
        out[~measured.valid] = 0.0
        return out

    def mean_squares(self, simulated: Sequence[Recording]) -> np.ndarray:
        """Return mean squared residuals per recording, (R, 2, n)."""
        return np.stack(
            [
                np.sum(self.residual(i, s) ** 2, axis=0) / max(int(np.sum(self.recordings[i].valid)), 1)
                for i, s in enumerate(simulated)
            ]
        )

    def pool(self, mean_squares: np.ndarray, held_out: bool = False) -> np.ndarray:
        """Return mean squares of the training (or held-out) recordings, pooled over samples, (2, n)."""
        part = slice(self.training, None) if held_out else slice(0, self.training)
        counts = np.array([int(np.sum(r.valid)) for r in self.recordings])[part]
        return np.average(mean_squares[part], axis=0, weights=counts)

    def least(self, held_out: bool = False) -> np.ndarray:
        """Return pooled mean squares (2, n) that a perfect model leaves: from noise and from divergence of
        correct simulations.
        """
        return self.pool(self.floor + self.immaterial, held_out)

    def objective(self, pooled: np.ndarray) -> float:
        """Return the weighted mean square of pooled residuals (2, n)."""
        return float(np.sum(pooled * self.weight**2))

    def score(self, mean_squares: np.ndarray, held_out: bool = False) -> float:
        """Return `Comparison.error` of the training or held-out recordings."""
        part = self.recordings[self.training :] if held_out else self.recordings[: self.training]
        scale = Scale.of(part)
        return normalised(self.pool(mean_squares, held_out), scale)

    def reweighed(self, mean_squares: np.ndarray, tolerance: float | None = None) -> Data:
        """Return the same data with weights for an error of this size, of which `tolerance` counts as noise.

        Where a model cannot reach the noise floor, a signal with little noise would dominate.
        """
        tolerance = POLICY.weighing_tolerance if tolerance is None else tolerance
        floor, error = self.pool(self.floor), self.pool(mean_squares)
        present = (floor > 0) & np.isfinite(Scale.of(self.recordings[: self.training]).stack())
        deviation = np.sqrt(floor + tolerance**2 * np.maximum(error - floor, 0.0))
        weight = np.where(present, 1.0 / np.where(present, deviation, 1.0), 0.0)
        return replace(self, weight=weight)


def gather(
    model: Model, training: Sequence[Recording], held_out: Sequence[Recording], seed: int
) -> tuple[Data, Simulated]:
    """Return runs of a model with and without noise, and the data with its floor, weighted for its error."""
    replay = replay_of(model, (*training, *held_out))
    simulated = replay.with_noise(model, seed)
    data = Data(
        recordings=replay.recordings,
        training=len(training),
        replay=replay,
        weight=np.ones((2, len(replay.recordings[0].axes))),
        budget=WorkBudget.for_search(training, replay.simulates),
        motion_periods=tuple(motion_period(r) for r in replay.recordings),
        **_floor(replay.recordings, simulated),
    )
    return data.weighed_for(data.mean_squares(simulated.clean)), simulated


def gather_along(
    model: Model, recordings: Sequence[Recording], training: int, seed: int
) -> tuple[Data, Simulated]:
    """Return the same as `gather`, along the measured motion, whatever loops produced it."""
    along = followed(recordings)
    return gather(model, along[:training], along[training:], seed)


def _floor(recordings: Sequence[Recording], simulated: Simulated) -> dict[str, Any]:
    """Return the noise floor from noisy and noise-free runs of one model, as `Data` stores it."""
    draws = tuple(
        tuple(difference(n, c, r) for n, c, r in zip(draw, simulated.clean, recordings, strict=True))
        for draw in simulated.noisy
    )
    counts = [max(int(np.sum(r.valid)), 1) for r in recordings]
    apart = np.stack([np.nan_to_num(simulated.immaterial(i)) / c for i, c in enumerate(counts)])
    floor = np.mean([[np.mean(x**2, axis=0) for x in draw] for draw in draws], axis=0)
    return {"floor": floor, "immaterial": apart, "draws": draws}


def difference(one: Recording, other: Recording, measured: Recording) -> np.ndarray:
    """The difference of the scored signals of two recordings, (N, 2, n); zero where there is no value."""
    out = np.zeros((len(measured), 2, len(measured.axes)))
    for k, name in enumerate(scored_signals(measured)):
        out[:, k] = one.signals[name] - other.signals[name]
    return out
