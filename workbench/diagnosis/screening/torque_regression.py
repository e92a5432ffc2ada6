"""Inverse-dynamics regression: the residual torque along measured motions, linear in all effects at once.

Along a motion that was measured, the torque that a machine needs is linear in nearly all parameters of nearly
all effects (the identification model of Gautier and Khalil, IEEE Trans. Robotics and Automation 6(3), 1990):
no simulation is needed to screen them, however many are missing together.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named
from workbench.models import Placement

from ..fitting.bounded_least_squares import solve
from ..fitting.normal_equations import Normal, jackknife, total
from .equations import Entry
from .sensitivity import Linearisation

Chosen = tuple[Entry, ...]
_Group = tuple[tuple[int, ...], Chosen]  #: axes, and effects that act on these and no others


@dataclass(frozen=True)
class Solution:
    """A set of effects with the coefficients that fit the training recordings.

    Attributes:
        coefficients: of the set, (C,).
        validated: mean square left on blocks that were left out of the fit, per axis (n,).
        test_loss: the same on held-out recordings; `validated` where these do not judge.
        each: coefficients with each of F folds left out of the fit, (F, C).
    """

    coefficients: np.ndarray
    validated: np.ndarray
    test_loss: np.ndarray
    each: np.ndarray

    @property
    def deviations(self) -> np.ndarray:
        """Return how far coefficients move with what they are fitted to (jackknife), (C,)."""
        return jackknife(self.each)


@dataclass(frozen=True)
class Regression:
    """Weighted residual torque and columns along the motions, as normal equations of folds and axes.

    Attributes:
        linearisation: the model and its motions.
        entries: effects in their places and shapes, each with the numbers of its columns.
        gains: the same of what scales the measured torque. Less of that leaves less of any residual, so that
            they are no proposals one by one.
        own: effects that the model states, each with the number of the column of what it does.
        folds: per fold and axis.
        held_out: per axis; None where held-out recordings do not judge.
        floor, test_floor: mean squares that noise leaves, per axis (n,).
        limits: physical bounds of each entry's coefficients.
        alike: effects that joints of one design share, at one size on all of them.
    """

    linearisation: Linearisation
    entries: tuple[Entry, ...]
    gains: tuple[Entry, ...]
    own: Mapping[EffectKey, int]
    folds: tuple[tuple[Normal, ...], ...]
    held_out: tuple[Normal, ...] | None
    floor: np.ndarray
    test_floor: np.ndarray
    limits: dict[Entry, tuple[np.ndarray, np.ndarray]]
    alike: tuple[Entry, ...] = ()
    _parts: dict[Chosen, Solution] = field(default_factory=dict, init=False, repr=False, compare=False)
    _fits: dict[Chosen, tuple[np.ndarray, np.ndarray]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )
    _copies: dict[EffectKey, list[Entry]] = field(default_factory=dict, init=False, repr=False, compare=False)
    _left: dict[Chosen, np.ndarray] = field(default_factory=dict, init=False, repr=False, compare=False)
    _groups: dict[Chosen, tuple[_Group, ...]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @cached_property
    def _axes(self) -> tuple[Normal, ...]:
        return tuple(total(own) for own in zip(*self.folds, strict=True))

    @cached_property
    def _acts(self) -> dict[Entry, frozenset[int]]:
        there = [np.diag(axis.gram) > 0.0 for axis in self._axes]
        return {
            e: frozenset(k for k, t in enumerate(there) if t[e.linear].any())
            for e in (*self.entries, *self.gains, *self.alike)
        }

    def axes_of(self, entry: Entry) -> frozenset[int]:
        """Return the axes on which an effect acts."""
        return self._acts[entry]

    def forms(self, entry: Entry) -> list[Entry]:
        """An effect, its special cases, and the effects of which it is a special case, in the same place."""
        form = set(entry.shape)
        return [entry, *(e for e in self.entries if e.key == entry.key and set(e.shape) != form)]

    def without_shape(self, keys: Container[EffectKey]) -> Chosen:
        """Return the effects of some keys that have nothing but a size."""
        return tuple(e for e in self.entries if e.key in keys and not e.shape)

    def copies(self, kin: Sequence[Entry]) -> list[Entry]:
        """Return further effects of a kind in one place, with shapes that can be distinguished from those
        present.
        """
        entry = kin[-1]
        repeats = effect_named(entry.key.effect).search.repeats
        place = Placement.of(self.linearisation.model, entry.key) if repeats else None
        if repeats is None or place is None:
            return []
        key = replace(entry.key, copy=entry.key.copy + 1)
        if key not in self._copies:
            alike = [e for e in self.entries if e.key.same_place(key)]
            made = [replace(e, key=key) for e in alike]
            self._acts.update((new, self._acts[e]) for new, e in zip(made, alike, strict=True))
            self.limits.update((new, self.limits[e]) for new, e in zip(made, alike, strict=True))
            self._copies[key] = made
        motions, others = self.linearisation.motions, [e.shape for e in kin]
        return [e for e in self._copies[key] if repeats(motions, place, e.shape, others)]

    def without_bounds(self, entry: Entry) -> Regression:
        """Return the regression in which the coefficients of one effect may be anything."""
        low, high = self.limits[entry]
        free = np.full(len(low), -np.inf), np.full(len(high), np.inf)
        out = replace(self, limits={**self.limits, entry: free})
        out._acts.update(self._acts)
        out._copies.update(self._copies)
        return out

    def _limits(self, chosen: Sequence[Entry]) -> tuple[np.ndarray, np.ndarray]:
        limits = [(np.zeros(0), np.zeros(0)), *(self.limits[e] for e in chosen)]
        return np.concatenate([low for low, _ in limits]), np.concatenate([high for _, high in limits])

    def left(self, chosen: Sequence[Entry]) -> np.ndarray:
        """Return the mean square per axis (n,) that a set of effects leaves on the data it is fitted to."""
        chosen = tuple(chosen)
        if chosen not in self._left:
            left = np.array([axis.square / axis.samples for axis in self._axes])
            for axes, own in self._apart(chosen):
                left[list(axes)] = self._fit(own, axes)[1]
            self._left[chosen] = left
        return self._left[chosen]

    def solved(self, chosen: Sequence[Entry], without: Sequence[EffectKey] = ()) -> Solution:
        """Return the fit of a set of effects within physical bounds, with its loss on other data.

        `without`: effects that the model states and that are taken out of it. Effects that share no axis, not
        through others either, are solved apart.
        """
        if without:
            return self._solved(tuple(chosen), range(len(self.floor)), without)
        bare = self._part((), range(len(self.floor)))
        left, test_loss = bare.validated.copy(), bare.test_loss.copy()
        # what acts on no axis stays nothing; the coefficients of all data come first
        found = {e: np.zeros((1 + len(self.folds), len(e.linear))) for e in chosen}
        for axes, own in self._apart(tuple(chosen)):
            part, rows = self._part(own, axes), list(axes)
            left[rows], test_loss[rows] = part.validated, part.test_loss
            ends = np.cumsum([len(e.linear) for e in own])[:-1]
            both = np.vstack([part.coefficients, part.each])
            found |= dict(zip(own, np.split(both, ends, axis=1), strict=True))
        whole = np.hstack([np.zeros((1 + len(self.folds), 0)), *(found[e] for e in chosen)])
        return Solution(whole[0], left, test_loss, whole[1:])

    def _apart(self, chosen: Chosen) -> tuple[_Group, ...]:
        """Groups of effects that share no axis, with their axes; effects that act on no axis are dropped.

        Sets that are asked for begin alike: what the last effect joins is worked out, all else is kept.
        """
        if not chosen:
            return ()
        if chosen not in self._groups:
            before, last = self._apart(chosen[:-1]), chosen[-1]
            axes = self.axes_of(last)
            apart = tuple(g for g in before if axes.isdisjoint(g[0]))
            touched = [g for g in before if g not in apart]
            if axes:
                own = sorted((e for g in touched for e in g[1]), key=chosen.index)
                apart += ((tuple(sorted(axes.union(*(g[0] for g in touched)))), (*own, last)),)
            self._groups[chosen] = apart
        return self._groups[chosen]

    def _part(self, chosen: Chosen, axes: Sequence[int]) -> Solution:
        """Return the (cached) fit of effects on all of their axes."""
        if chosen not in self._parts:
            self._parts[chosen] = self._solved(chosen, axes, ())
        return self._parts[chosen]

    def _fit(self, chosen: Chosen, axes: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Return the (cached) coefficients of effects (C,) and the mean square left on each of their axes."""
        if chosen not in self._fits:
            pieces = [self._axes[k].pick(_columns(chosen)) for k in axes]
            coefficients = solve(total(pieces), *self._limits(chosen))
            left = [axis.after(coefficients) / axis.samples for axis in pieces]
            self._fits[chosen] = coefficients, np.array(left)
        return self._fits[chosen]

    def _solved(self, chosen: Chosen, axes: Sequence[int], without: Sequence[EffectKey]) -> Solution:
        """Return the fit on some axes, which must be all that the effects act on, with `validated` and
        `test_loss` of these axes.
        """
        index, limits = _columns(chosen), self._limits(chosen)
        out = [self.own[key] for key in without]

        def of(pieces: Sequence[Normal]) -> list[Normal]:
            return [_taken_out(pieces[k], out).pick(index) for k in axes]

        folds = [of(fold) for fold in self.folds]
        wholes = [total(fold) for fold in folds]
        whole = total(wholes)
        coefficients = solve(whole, *limits) if without else self._fit(chosen, axes)[0]
        left = np.zeros(len(axes))
        each = np.stack([solve(whole - own, *limits) for own in wholes])
        for fold, rest in zip(folds, each, strict=True):
            left += [axis.after(rest) for axis in fold]
        left *= len(axes) / whole.samples
        if self.held_out is None:
            return Solution(coefficients, left, left, each)
        test_loss = [axis.after(coefficients) / axis.samples for axis in of(self.held_out)]
        return Solution(coefficients, left, np.array(test_loss), each)


def _columns(chosen: Chosen) -> list[int]:
    return [k for e in chosen for k in e.linear]


def _taken_out(piece: Normal, columns: Sequence[int]) -> Normal:
    """Return the regression with the contribution of these columns added back to the residual."""
    for k in columns:
        square = piece.square + 2.0 * piece.right[k] + piece.gram[k, k]
        piece = Normal(piece.gram, piece.right + piece.gram[:, k], float(square), piece.samples)
    return piece
