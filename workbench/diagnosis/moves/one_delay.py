"""Whether one delay of the whole machine explains the recordings: fitted at once, where screening is dear."""

from __future__ import annotations

import numpy as np

from workbench.effects import effect_named, kinds, places
from workbench.models import AppliedEffect, Placement

from ..fitting.fit import fit
from ..fitting.refinement import applied_effect
from ..hypothesis import Hypothesis
from ..loss import explained
from ..policy import POLICY
from ..problem import Problem


def one_delay_may_suffice(problem: Problem) -> bool:
    """Return whether a delay of commands or of sensors alone explains what a search has to explain.

    On many axes it looks like damping and a rotor on each of them, in proportion to the gains of its loop.
    """
    start, along = problem.start, problem.inverse_dynamics
    if along is None:
        return False
    model, motions = start.hypothesis.model, along[2].linearisation.motions
    tried = []
    for key in places(model):
        effect = effect_named(key.effect)
        if key.axis is not None or not kinds.is_pure_delay(effect):
            continue
        starts = effect.parameters.shapes(motions, model, Placement.of(model, key))
        if starts:
            values = effect.parameters.to_values(np.zeros(0), starts[len(starts) // 2])
            tried.append(Hypothesis(model, (applied_effect(model, AppliedEffect(key), values),)))
    fits = fit(tried, problem.data)
    return any(
        f is not None and explained(problem.data, start, f, problem.data) >= POLICY.explained for f in fits
    )
