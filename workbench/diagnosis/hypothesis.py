"""Hypotheses (a model with effects) and their fits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from workbench.core import EffectKey, Estimate, Recording
from workbench.effects import axis_units, effect_named, kinds
from workbench.models import AppliedEffect, Model, Placement


@dataclass(frozen=True)
class Hypothesis:
    """A model, effects whose values its file states, and effects with free parameters."""

    base: Model
    free: tuple[AppliedEffect, ...]
    parameter_free: tuple[AppliedEffect, ...] = ()

    @property
    def added(self) -> tuple[AppliedEffect, ...]:
        """Return all effects added to the base model."""
        return (*self.parameter_free, *self.free)

    @property
    def keys(self) -> frozenset[EffectKey]:
        """Return the keys of these effects."""
        return frozenset(a.key for a in self.added)

    @property
    def diverges(self) -> bool:
        """Return whether trajectories diverge for small changes of its parameters."""
        return any(kinds.diverges(effect_named(a.key.effect)) for a in self.free)

    @property
    def size(self) -> int:
        """Return the number of free parameters."""
        return sum(effect_named(a.key.effect).parameters.count(a.values) for a in self.free)

    @property
    def model(self) -> Model:
        """Return the base model with all effects."""
        out = self.base
        for applied in self.added:
            out = out.with_effect(applied)
        return out

    def without(self, key: EffectKey) -> Hypothesis:
        """Return the hypothesis without one free effect."""
        return replace(self, free=tuple(a for a in self.free if a.key != key))


@dataclass(frozen=True)
class Fit:
    """A hypothesis after fitting.

    Attributes:
        hypothesis: with the estimates and their deviations.
        simulated: its runs of all recordings.
        mean_squares: (R, 2, n).
        training_loss: weighted mean square on the training data.
        test_loss: the same on held-out data, or cross-validated on folds.
        fold_losses: test loss of each fold (or held-out recording), (F,).
    """

    hypothesis: Hypothesis
    simulated: tuple[Recording, ...]
    mean_squares: np.ndarray
    training_loss: float
    test_loss: float
    fold_losses: np.ndarray


def stated_forms(applied: AppliedEffect) -> frozenset[str]:
    """Return the parameters that say which form of an effect is meant: stated, not estimated."""
    parameters = effect_named(applied.key.effect).parameters
    optional = {p.name for p in parameters if p.optional and p.name in applied.parameters}
    if not optional:
        return frozenset()
    _, shape = parameters.to_coefficients(applied.values)
    return frozenset(optional & shape.keys())


def blocks(hypothesis: Hypothesis) -> list[tuple[AppliedEffect, slice]]:
    """Return which unknowns belong to which free effect: linear coefficients, then nonlinear parameters."""
    out, start = [], 0
    for applied in hypothesis.free:
        effect = effect_named(applied.key.effect)
        size = len(effect.parameters.to_coefficients(applied.values)[0]) + len(effect.parameters.nonlinear)
        out.append((applied, slice(start, start + size)))
        start += size
    return out


def step_bounds(hypothesis: Hypothesis) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds (C,) of one step: the physical bounds, and the longest step of nonlinear unknowns.

    An unknown that starts outside its bound has to return.
    """
    low, high = [np.zeros(0)], [np.zeros(0)]
    for applied, _ in blocks(hypothesis):
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.parameters.to_coefficients(applied.values)
        place = Placement.of(hypothesis.base, applied.key)
        lower, upper = effect.parameters.bounds(hypothesis.base, place, shape)
        own, limits = effect.parameters.reach(shape), effect.parameters.shape_bounds(hypothesis.base, place)
        reach = np.array([own[name] for name in effect.parameters.nonlinear])
        now = np.array([shape[name] for name in effect.parameters.nonlinear])
        floor = np.array([limits[name][0] for name in effect.parameters.nonlinear])
        ceiling = np.array([limits[name][1] for name in effect.parameters.nonlinear])
        low += [lower - coefficients, np.maximum(-reach, floor - now)]
        high += [upper - coefficients, np.maximum(np.minimum(reach, ceiling - now), low[-1])]
    return np.concatenate(low), np.concatenate(high)


def moved(hypothesis: Hypothesis, change: np.ndarray) -> Hypothesis:
    """Return the hypothesis with its unknowns changed by `change`, in the order of `blocks`."""
    free = []
    for applied, block in blocks(hypothesis):
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.parameters.to_coefficients(applied.values)
        own = change[block]
        changed = {
            name: shape[name] + own[len(coefficients) + k]
            for k, name in enumerate(effect.parameters.nonlinear)
        }
        shape = {**shape, **changed}
        values = effect.parameters.to_values(coefficients + own[: len(coefficients)], shape)
        free.append(applied_effect(hypothesis.base, applied, values))
    return replace(hypothesis, free=tuple(free))


def applied_effect(model: Model, like: AppliedEffect, values: dict[str, float]) -> AppliedEffect:
    """Return the same effect with other values."""
    units = axis_units(model)
    parameters = {}
    for parameter in effect_named(like.key.effect).parameters:
        unit = (
            parameter.unit
            if like.key.axis is None
            else parameter.unit_on(units[model.axes.index(like.key.axis)])
        )
        if parameter.name in values:
            parameters[parameter.name] = Estimate(float(values[parameter.name]), 0.0, unit)
    return AppliedEffect(like.key, parameters)
