"""Normal equations of effects: what each leaves of the data, both fitted and left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import effect_named
from workbench.models import Model, Placement

from ..data import Data
from ..fitting.bounded_least_squares import solve
from ..fitting.normal_equations import Normal, normal, total
from .propagation import propagate_sensitivities
from .sensitivity import Linearisation, SensitivityColumn

_BLOCK = 64  # columns propagated together


@dataclass(frozen=True, eq=False)
class Entry:
    """An effect of one shape: the indices of its columns, and the effect at unit size.

    `alike`: the same effect on each of several joints of one design, of which this one is all at one size.
    """

    key: EffectKey
    shape: Mapping[str, float]
    linear: list[int]
    fixed: int | None
    strength: float
    alike: tuple[Entry, ...] = ()

    @property
    def members(self) -> tuple[Entry, ...]:
        """Return the effects of single places that this entry stands for."""
        return self.alike or (self,)

    @property
    def is_extended(self) -> bool:
        """Return whether its form is only a refinement of the usual one, and no effect of its own."""
        return effect_named(self.key.effect).parameters.is_extended(self.shape)


def limits_of(model: Model, entry: Entry) -> tuple[np.ndarray, np.ndarray]:
    """Return physical bounds of an entry's coefficients in a model."""
    place = Placement.of(model, entry.key)
    bounds = effect_named(entry.key.effect).parameters.bounds(model, place, entry.shape)
    return bounds[0][: len(entry.linear)], bounds[1][: len(entry.linear)]


def bounds_of(
    linearisation: Linearisation, entries: Sequence[Entry], kept: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Physical bounds of the coefficients of entries, after the first `kept` unknowns, which have none."""
    limits = [
        (np.full(kept, -np.inf), np.full(kept, np.inf)),
        *(limits_of(linearisation.model, e) for e in entries),
    ]
    return np.concatenate([low for low, _ in limits]), np.concatenate([high for _, high in limits])


@dataclass(frozen=True)
class Equations:
    """Normal equations of effects in their shapes: of each training fold, and of the held-out data for the
    test.
    """

    entries: tuple[Entry, ...]
    pieces: list[Normal]
    held_out: Normal | None

    def judged(
        self,
        entries: Sequence[Entry],
        bounds: tuple[np.ndarray | float, np.ndarray | float] = (-np.inf, np.inf),
        kept: Sequence[int] = (),
    ) -> tuple[float, np.ndarray]:
        """Return the mean square left on held-out data (or across folds), and the solution on all training
        data.

        Args:
            entries: effects that are fitted together.
            bounds: of the unknowns; none by default.
            kept: unknowns that stand before theirs.
        """
        index = [*kept, *(k for e in entries for k in e.linear)]
        fixed = [e.fixed for e in entries if e.fixed is not None]
        parts = [_shifted(p, index, fixed) for p in self.pieces]
        whole = total(parts)
        solution = solve(whole, *bounds)
        if self.held_out is not None:
            other = _shifted(self.held_out, index, fixed)
            return other.after(solution) / other.samples, solution
        left = 0.0
        for part in parts:
            rest = whole - part
            left += part.after(solve(rest, *bounds))
        return left / whole.samples, solution


def equations(
    linearisation: Linearisation,
    known: list[np.ndarray],
    columns: list[SensitivityColumn],
    entries: Sequence[Entry],
    data: Data,
) -> Equations:
    """Return normal equations of the columns of entries.

    `known`: responses of the unknowns that stand before `columns`, per recording.
    """
    return equations_of(responses(linearisation, known, columns, data), entries, data, linearisation.runs)


def responses(
    linearisation: Linearisation, known: list[np.ndarray], columns: list[SensitivityColumn], data: Data
) -> list[np.ndarray]:
    """Return weighted changes of the signals by each unknown, (N, 2, n, C) per recording."""
    parts = [
        propagate_sensitivities([linearisation], [columns[k : k + _BLOCK]], data)[0]
        for k in range(0, len(columns), _BLOCK)
    ]
    each = zip(*([known] if known else []), *parts, strict=True)
    return [own[0] if len(own) == 1 else np.concatenate(own, axis=-1) for own in each]


def equations_of(
    changes: Sequence[np.ndarray], entries: Sequence[Entry], data: Data, simulated: Sequence[Recording]
) -> Equations:
    """Return normal equations from `responses`."""
    residuals = [data.residual(i, s) * data.weight for i, s in enumerate(simulated)]
    pieces = [normal(changes[f.recording][f.rows], residuals[f.recording][f.rows]) for f in data.folds]
    held_out: Normal | None = None
    for i in range(data.training, len(simulated) if data.tests_on_holdout else data.training):
        own = normal(changes[i], residuals[i])
        held_out = own if held_out is None else held_out + own
    return Equations(tuple(entries), pieces, held_out)


def _shifted(piece: Normal, index: list[int], fixed: Sequence[int]) -> Normal:
    for k in fixed:
        right = piece.right - piece.gram[:, k]
        square = piece.square - 2.0 * piece.right[k] + piece.gram[k, k]
        piece = Normal(piece.gram, right, float(square), piece.samples)
    return piece.pick(index)
