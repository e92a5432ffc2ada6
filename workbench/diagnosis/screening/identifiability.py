"""Identifiability: which effects the recordings can distinguish, computed from sensitivities before any
search.

All effects in all places are columns of one linear problem about the model's runs. What noise does to an
estimate follows from them, alone and beside any other effect (L. Ljung, System Identification, 1999, ch. 9).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from workbench.core import EffectKey, Estimate, Identifiability
from workbench.effects import effect_named, kinds
from workbench.models import AppliedEffect, Model

from ..fitting.uncertainty import with_deviations
from ..hypothesis import Hypothesis, applied_effect
from ..policy import POLICY
from .equations import Entry, limits_of
from .ground_effects import unobservable_effects
from .linear_problem import Linear, columns_of
from .sensitivity import Linearisation


def identifiability_of(linear: Linear, linearisation: Linearisation) -> Identifiability:
    """Which effects of small size the recordings can tell apart, and how precisely each would be known."""
    shows = [linear.shown(e) >= POLICY.significant for e in linear.entries]
    excited = [e for e, shown in zip(linear.entries, shows, strict=True) if shown]
    silent = [e.key for e, shown in zip(linear.entries, shows, strict=True) if not shown]
    groups = _groups(linear, excited)
    alike = {key for group in groups for key in group}
    return Identifiability(
        separable=tuple(e.key for e in excited if e.key not in alike),
        groups=groups,
        not_excited=(*unobservable_effects(linearisation), *silent),
        expected=tuple((e.key, x) for e in excited if (x := _expected(linear, e, linearisation))),
    )


def _groups(linear: Linear, excited: Sequence[Entry]) -> tuple[tuple[EffectKey, ...], ...]:
    """Return groups of effects that can replace each other; effects linked by a third form one group."""
    sets: dict[EffectKey, set[EffectKey]] = {e.key: {e.key} for e in excited}
    for one, other in combinations(excited, 2):
        related = linear.correlation(columns_of(one), columns_of(other)) >= POLICY.related
        if related and all(
            linear.differs(a, b) < POLICY.significant for a, b in ((one, other), (other, one))
        ):
            joined = sets[one.key] | sets[other.key]
            for key in joined:
                sets[key] = joined
    found = {frozenset(s) for s in sets.values() if len(s) > 1}
    order = [e.key for e in excited]
    return tuple(sorted((tuple(sorted(g, key=order.index)) for g in found), key=lambda g: order.index(g[0])))


def _expected(linear: Linear, entry: Entry, linearisation: Linearisation) -> Mapping[str, Estimate]:
    """Return the expected parameters of a small effect fitted alone, with deviations due to noise.

    Nonlinear parameters are held where they are, but for those of effects that have no others.
    """
    effect, model = effect_named(entry.key.effect), linearisation.model
    if kinds.free_parameters(effect, model) == 0:
        return {}
    own, count = columns_of(entry), len(entry.linear)
    covariance = np.zeros((count + len(effect.parameters.nonlinear),) * 2)
    asked = [p.name for p in effect.parameters if p.name not in effect.parameters.nonlinear]
    if count:
        covariance[:count, :count] = linear.covariance(own)
    elif len(effect.parameters.nonlinear) == 1:
        asked = list(effect.parameters.nonlinear)
        covariance[0, 0] = linear.covariance(own)[0, 0] * entry.shape[asked[0]] ** 2
    coefficients = np.full(count, linear.small(entry))
    values = effect.parameters.to_values(coefficients, entry.shape)
    applied = applied_effect(model, AppliedEffect(entry.key), values)
    (known,) = with_deviations(Hypothesis(model, (applied,)), covariance, linearisation.data).free
    return {name: known.parameters[name] for name in asked if name in known.parameters}


def inseparable(linear: Linear, applied: AppliedEffect, model: Model) -> tuple[EffectKey, ...]:
    """Return effects that can replace one of the found size in a model, and that it can replace."""
    coefficients = effect_named(applied.key.effect).parameters.to_coefficients(applied.values)[0]
    alike = [e for e in linear.entries if e.key == applied.key and len(e.linear) == len(coefficients)]
    if not alike:
        return ()
    own = alike[-1]
    times = (
        float(np.max(np.abs(coefficients), initial=0.0)) / linear.small(own) if own.strength > 0.0 else 0.0
    )
    out = []
    for other in linear.entries:
        related = linear.correlation(columns_of(own), columns_of(other)) >= POLICY.related
        if other is own or not related or not times:
            continue
        apart = times * max(linear.differs(own, other), linear.differs(other, own))
        if apart < POLICY.significant and _can_replace(other, own, coefficients, linear, model):
            out.append(other.key)
    return tuple(out)


def _can_replace(other: Entry, own: Entry, coefficients: np.ndarray, linear: Linear, model: Model) -> bool:
    """Return whether the size with which one effect would replace another is physically possible.

    Where a file states no rotor, none can be smaller: an inertia that is too large is the link's.
    """
    if not (other.linear and own.linear):
        return True
    low, high = limits_of(model, other)
    doubt = POLICY.significant * np.sqrt(np.diag(linear.covariance(other.linear)))
    size = linear.replacement(own.linear, coefficients, other.linear)
    return bool(((low - doubt <= size) & (size <= high + doubt)).all())
