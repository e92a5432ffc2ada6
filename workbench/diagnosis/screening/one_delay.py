"""Whether one delay of the whole machine explains the recordings: fitted where screening is costly."""

from __future__ import annotations

import numpy as np

from workbench.effects import effect_named, kinds, places
from workbench.models import AppliedEffect, Placement

from ..data import Data
from ..fitting.fit import fit
from ..hypothesis import Fit, Hypothesis, applied_effect
from ..loss import explained
from ..policy import POLICY
from .sensitivity import Linearisation


def one_delay_may_suffice(start: Fit, data: Data, along: Linearisation) -> bool:
    """Return whether a delay of commands or of sensors alone explains what a search has to explain.

    On many axes it looks like damping and a rotor on each of them, in proportion to the gains of its loop.

    Args:
        start: the unchanged model.
        data: its recordings.
        along: about their measured motions, which tell where to start.
    """
    model, motions = start.hypothesis.model, along.motions
    tried = []
    for key in places(model):
        effect = effect_named(key.effect)
        if key.axis is not None or not kinds.is_pure_delay(effect):
            continue
        starts = effect.parameters.shapes(motions, model, Placement.of(model, key))
        if starts:
            values = effect.parameters.to_values(np.zeros(0), starts[len(starts) // 2])
            tried.append(Hypothesis(model, (applied_effect(model, AppliedEffect(key), values),)))
    fits = fit(tried, data)
    return any(f is not None and explained(data, start, f, data) >= POLICY.explained for f in fits)
