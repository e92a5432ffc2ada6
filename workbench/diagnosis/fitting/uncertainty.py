"""Uncertainty of estimates: from noise, from folds (jackknife), and from other fits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from workbench.core import Estimate
from workbench.effects import Effect, Parameter, Values, effect_named, kinds, model_value
from workbench.models import AppliedEffect, Placement

from ..data import Data
from ..hypothesis import Fit, Hypothesis, blocks, stated_forms
from ..policy import POLICY
from .normal_equations import Normal


def widened(found: Fit, other: Fit) -> Fit:
    """Return the fit with deviations no smaller than those of another fit of the same effects."""
    there = [a.parameters for a in other.hypothesis.free]
    return _deviating(found, lambda k, name, own: max(own.std, there[k][name].std))


def moved_apart(found: Fit, own: Fit, others: Sequence[Fit]) -> Fit:
    """Return the fit with deviations that cover a share of the distance from `own` to `others`."""

    def value(of: Fit, k: int, name: str) -> float:
        return of.hypothesis.free[k].parameters[name].value

    def deviation(k: int, name: str, estimate: Estimate) -> float:
        away = max((abs(value(o, k, name) - value(own, k, name)) for o in others), default=0.0)
        return float(np.hypot(estimate.std, POLICY.rival_deviation * away))

    return _deviating(found, deviation)


def _deviating(found: Fit, deviation: Callable[[int, str, Estimate], float]) -> Fit:
    """The fit with other deviations, by index of the effect, name of the parameter and its estimate."""
    free = tuple(
        AppliedEffect(a.key, {n: replace(e, std=deviation(k, n, e)) for n, e in a.parameters.items()})
        for k, a in enumerate(found.hypothesis.free)
    )
    return replace(found, hypothesis=replace(found.hypothesis, free=free))


def covariance_of(
    total: Normal, noise: np.ndarray, changes: np.ndarray, value: float, data: Data
) -> np.ndarray:
    """Return the covariance of the unknowns (C, C): from noise, and from leaving out folds (jackknife).

    At the noise floor the first is right. Above it the model is wrong somewhere, residuals are not
    noise, and the jackknife over folds says how far estimates move.
    """
    if len(total.right) == 0:
        return np.zeros((0, 0))
    inverse = np.linalg.pinv(total.gram, rcond=1e-10)
    from_noise = inverse @ noise @ inverse
    excess = value / max(data.objective(data.pool(data.floor)), 1e-300)
    if excess < POLICY.jackknife_from:
        return from_noise
    count = len(changes)
    moves = changes - changes.mean(axis=0)
    jackknife = (count - 1) / count * moves.T @ moves
    return from_noise * excess + jackknife


def scatter(draws: list[np.ndarray], response: np.ndarray) -> np.ndarray:
    """The covariance (C, C) of the right-hand side that noise causes in one recording, from its draws; all
    weighted.
    """
    flat = response.reshape(draws[0].size, response.shape[-1])
    hits = np.stack([flat.T @ d.reshape(-1) for d in draws])
    return hits.T @ hits / len(hits)


def with_deviations(hypothesis: Hypothesis, covariance: np.ndarray, data: Data) -> Hypothesis:
    """Return standard deviations of the parameters by the delta method."""
    free = []
    floor = data.pool(data.floor)
    for applied, block in blocks(hypothesis):
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.parameters.to_coefficients(applied.values)
        unknowns = np.array([*coefficients, *(shape[name] for name in effect.parameters.nonlinear)])
        own = covariance[block, block]

        there = [p for p in effect.parameters if p.name in applied.parameters]
        values = partial(_values, effect, shape, there, len(coefficients))
        middle = values(unknowns)
        slopes = np.empty((len(middle), len(unknowns)))
        for i in range(len(unknowns)):
            step = 1e-4 * max(abs(unknowns[i]), 1e-6)
            slopes[:, i] = (values(unknowns + step * (np.arange(len(unknowns)) == i)) - middle) / step
        deviation = np.sqrt(np.maximum(np.diag(slopes @ own @ slopes.T), 0.0))
        # a delay acts inside a step through means; dry friction sets in some way that no log shows whole
        timed = np.array([p.unit == "s" for p in there])
        late = POLICY.delay_deviation * data.recordings[0].period * timed
        many = len(there) > 1
        soft = POLICY.onset_deviation_of_many if many else POLICY.onset_deviation
        onset = soft * kinds.is_dry(effect) * np.abs(middle)
        place = Placement.of(hypothesis.base, applied.key)
        neutral = np.array([p.neutral for p in there])
        share = POLICY.model_deviation if data.replay.smooth else POLICY.start_deviation
        # of a number that the model has, what right simulations differ by is a share of the whole number
        whole = np.abs(middle - neutral)
        if (own := model_value(effect, hypothesis.base, place, applied.values)) and effect.corrects:
            more = abs(applied.values[effect.corrects.told_by(applied.values).parameter])
            whole += abs(own) * whole / max(more, 1e-300)  # what goes with it, in proportion
        fine = np.sqrt(late**2 + onset**2 + (share * whole) ** 2)
        axis = applied.key.axis
        noise = floor.max(axis=1) if axis is None else floor[:, hypothesis.base.axes.index(axis)]
        blur = effect.parameters.blur(applied.values, *(float(x) for x in np.sqrt(noise)))
        fine = np.hypot(fine, np.array([blur.get(p.name, 0.0) for p in there]))
        estimated = np.array([p.name not in stated_forms(applied) for p in there])
        deviation = np.hypot(deviation, fine) * estimated
        parameters = {
            p.name: Estimate(float(middle[i]), float(deviation[i]), applied.parameters[p.name].unit)
            for i, p in enumerate(there)
        }
        free.append(AppliedEffect(applied.key, parameters))
    return replace(hypothesis, free=tuple(free))


def _values(
    effect: Effect, shape: Values, there: Sequence[Parameter], count: int, unknowns: np.ndarray
) -> np.ndarray:
    """Return parameters of an effect from its `count` linear coefficients and its nonlinear parameters."""
    changed = dict(zip(effect.parameters.nonlinear, unknowns[count:], strict=True))
    named = effect.parameters.to_values(unknowns[:count], {**shape, **changed})
    return np.array([named[p.name] for p in there])
