"""Every effect in every place as columns of one linear problem, with the influence of noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named, places

from ..fitting.normal_equations import Normal, scaled_inverse, total
from ..fitting.uncertainty import scatter
from ..policy import POLICY
from .equations import Entry, Equations, equations_of, responses
from .screen import entries_of
from .sensitivity import Linearisation
from .torque_regression import Regression

_SAME_TOLERANCE = 1e-9  # share of a column that others leave where they are the same


class Linear:
    """Every effect with mid-range shape parameters, and normal equations of all columns by training
    recording.

    Attributes:
        entries: one for each effect in each place.
        forms: each effect in all of its shapes.
        own: normal equations of each recording.
        quiet: squared residual of each that noise alone leaves, (R,).
        equations: of all effects in all shapes as they travel round loops; None along a measured motion.
    """

    def __init__(
        self,
        entries: Sequence[Entry],
        own: Sequence[Normal],
        quiet: np.ndarray,
        scattered: np.ndarray,
        white: float,
        equations: Equations | None = None,
    ) -> None:
        """`scattered`: covariance of the right-hand side due to noise; `white`: mean square of noise in one
        value.
        """
        self.own, self.quiet, self.equations = tuple(own), quiet, equations
        self._gram, self._noise, self._white = total(self.own).gram, scattered, white
        self.forms = tuple(entries)
        shapes: dict[EffectKey, list[Entry]] = {}
        for entry in entries:
            if not effect_named(entry.key.effect).parameters.is_special(entry.shape):
                shapes.setdefault(entry.key, []).append(entry)
        self.entries = tuple(sorted(own, key=self.shown)[len(own) // 2] for own in shapes.values())

    @property
    def excess(self) -> np.ndarray:
        """Return the squared residual of each recording above the noise, (R,)."""
        return np.array([p.square for p in self.own]) - self.quiet

    def small(self, entry: Entry) -> float:
        """Return the coefficient at which an effect has the share `small_effect` of the torque."""
        return POLICY.small_effect / entry.strength

    def covariance(self, index: Sequence[int]) -> np.ndarray:
        """The covariance, due to noise alone, of the coefficients of columns that are fitted together."""
        inverse = self._inverse(index)
        return inverse @ self._noise[np.ix_(index, index)] @ inverse

    def _inverse(self, index: Sequence[int]) -> np.ndarray:
        return scaled_inverse(self._gram[np.ix_(index, index)])

    def shown(self, entry: Entry) -> float:
        """Return how many deviations a small effect is from zero, beside its own special cases."""
        own = columns_of(entry)
        return self._beyond(own[-1], own[:-1], entry) if own else 0.0

    def differs(self, entry: Entry, other: Entry) -> float:
        """How many deviations separate a small effect from another effect, in the part that differs most."""
        return max(self._beyond(k, columns_of(other), entry) for k in columns_of(entry))

    def _beyond(self, column: int, others: Sequence[int], entry: Entry) -> float:
        if entry.strength == 0.0 or self._gram[column, column] <= 0.0:
            return 0.0
        beside = [k for k in others if self._gram[k, k] > 0.0]
        if beside:
            block, cross = self._gram[np.ix_(beside, beside)], self._gram[beside, column]
            same = cross @ np.linalg.lstsq(block, cross, rcond=1e-12)[0]
            if same > (1.0 - _SAME_TOLERANCE) * self._gram[column, column]:
                return 0.0
        index = [*beside, column]
        # few draws of the noise may miss a direction, in which it is taken as white
        variance = max(self.covariance(index)[-1, -1], self._white * self._inverse(index)[-1, -1])
        return float(self.small(entry) / np.sqrt(max(variance, 1e-300)))

    def replacement(self, one: Sequence[int], coefficients: np.ndarray, other: Sequence[int]) -> np.ndarray:
        """Return the coefficients of other columns that come closest to some columns with theirs."""
        block, cross = self._gram[np.ix_(other, other)], self._gram[np.ix_(other, one)]
        return np.linalg.lstsq(block, cross @ coefficients, rcond=1e-12)[0]

    def correlation(self, one: Sequence[int], other: Sequence[int]) -> float:
        """Return the largest absolute correlation of any column of one effect with any column of another."""
        size = np.sqrt(np.maximum(np.outer(np.diag(self._gram)[one], np.diag(self._gram)[other]), 1e-300))
        return float(np.max(np.abs(self._gram[np.ix_(one, other)]) / size, initial=0.0))


def columns_of(entry: Entry) -> list[int]:
    """Return the columns of an effect; for an effect without coefficients, its total contribution."""
    return entry.linear or ([entry.fixed] if entry.fixed is not None else [])


def linear_of(linearisation: Linearisation) -> Linear:
    """Return the problem of all effects as they propagate round the loops of the recordings."""
    data, (columns, entries) = linearisation.data, entries_of(linearisation)
    changes = responses(linearisation, [], columns, data)
    known = equations_of(changes, entries, data, linearisation.runs)
    each, white = range(data.training), data.weight**2
    own = [
        total([p for p, f in zip(known.pieces, data.folds, strict=True) if f.recording == i]) for i in each
    ]
    spread = [scatter([draw[i] * data.weight for draw in data.draws], changes[i]) for i in each]
    quiet = np.array([np.sum(data.floor[i] * white) * len(linearisation.runs[i]) for i in each])
    level = quiet.sum() / max(sum(p.samples for p in own) * np.count_nonzero(white), 1)
    return Linear(entries, own, quiet, np.sum(spread, axis=0), level, known)


def is_too_large(linearisation: Linearisation) -> bool:
    """Return whether the responses of all effects at all rows would not fit into memory."""
    values = sum(run.signals["position"].size for run in linearisation.runs[: linearisation.data.training])
    return 2 * values * len(places(linearisation.model)) > POLICY.pair_values


def linear_along(regression: Regression) -> Linear:
    """The problem of all effects that are torques, along the measured motion of the training recordings."""
    own: dict[int, Normal] = {}
    data = regression.linearisation.data
    quiet = np.zeros(data.training)
    for fold, axes in zip(data.folds, regression.folds, strict=True):
        piece = total(axes)
        own[fold.recording] = own[fold.recording] + piece if fold.recording in own else piece
        quiet[fold.recording] += sum(a.samples * f for a, f in zip(axes, regression.floor, strict=True))
    each = zip(*regression.folds, strict=True)
    scattered = np.sum([total(axis).gram * f for axis, f in zip(each, regression.floor, strict=True)], axis=0)
    return Linear(regression.entries, list(own.values()), quiet, scattered, 0.0)
