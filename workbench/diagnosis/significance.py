"""Whether an effect of a fit can be named: its estimate is significant, and the motions identify it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.effects import Parameter, effect_named, kinds
from workbench.models import AppliedEffect, Model, Placement

from .hypothesis import Fit, stated_forms
from .policy import POLICY
from .screening.sensitivity import Linearisation, SensitivityColumn, combine

INTERVAL = 1.96  #: deviations of the 95 % interval that is reported


def identifiable(linearisation: Linearisation, found: Fit) -> bool:
    """Return whether the motions identify each free effect, and none is at its physical bound."""
    return all(
        told_by_motion(linearisation, a, found) and not _at_its_limit(found.hypothesis.model, a)
        for a in found.hypothesis.free
    )


def told_by_motion(linearisation: Linearisation, applied: AppliedEffect, found: Fit) -> bool:
    """Return whether the motions identify each of the free effects, also beside effects whose torque it
    resembles.

    A spring and a wave over a short arc are two terms of a series: they follow any spring.
    """
    key, effect = applied.key, effect_named(applied.key.effect)
    place, motions = Placement.of(found.hypothesis.model, key), linearisation.motions
    if not effect.parameters.told(motions, place, applied.values):
        return False
    if effect.search.told_beside is None:
        return True
    alike = [
        a.key
        for a in found.hypothesis.free
        if (a.key.axis, a.key.location) == (key.axis, key.location)
        and not a.key.same_place(key)
        and kinds.depends_on(effect_named(a.key.effect)) == kinds.depends_on(effect)
    ]
    return effect.search.told_beside(motions, place, applied.values, len(alike))


def _at_its_limit(model: Model, applied: AppliedEffect) -> bool:
    """Return whether an effect is at its physical bound: then it approximates another cause."""
    effect = effect_named(applied.key.effect)
    coefficients, shape = effect.parameters.to_coefficients(applied.values)
    lower, upper = effect.parameters.bounds(model, Placement.of(model, applied.key), shape)
    # what grows without limit ends at nothing, which a machine may well have
    limits = np.where(np.isfinite(upper) & (np.array([lower, upper]) != 0.0), [lower, upper], np.nan)
    return bool(np.isclose(coefficients, limits, rtol=1e-6, atol=0.0).any())


def is_significant(applied: AppliedEffect, deviations: float | None = None) -> bool:
    """Return whether an estimate differs significantly from its neutral value.

    One that helps and may yet be nothing stands for something else: in a simulator even a lag of no length
    may change at which instant a signal is read.
    """
    return significance(applied) > (POLICY.significant if deviations is None else deviations)


def significance(applied: AppliedEffect) -> float:
    """Return by how many standard deviations the clearest parameter differs from its neutral value."""
    estimates = [(applied.parameters[p.name], p.neutral) for p in sizes_of(applied)]
    return max((abs(e.value - none) / max(e.std, 1e-300) for e, none in estimates), default=0.0)


def sizes_of(applied: AppliedEffect) -> Sequence[Parameter]:
    """Return the parameters that give the size of an effect, not its place or shape; all if none does."""
    effect = effect_named(applied.key.effect)
    there = [p for p in effect.parameters if p.name in applied.parameters]
    turns = [p.name for p in there if p.upper - p.lower <= 2.0 * np.pi and p.unit == "rad"]
    sizes = [p for p in there if p.name not in (*effect.parameters.nonlinear, *turns, *stated_forms(applied))]
    return sizes or there


def cancel_each_other(linearisation: Linearisation, found: Fit) -> bool:
    """Whether effects mostly cancel each other: two smooth curves that imitate a third, not two causes."""
    totals = [linearisation.total(a, a.values) for a in found.hypothesis.free]
    if len(totals) < 2:
        return False

    def size(column: SensitivityColumn) -> float:
        return float(np.sqrt(sum(np.sum(t**2) for t in column.torque)))

    return sum(map(size, totals)) > POLICY.cancelling * size(combine(totals, [1.0] * len(totals)))
