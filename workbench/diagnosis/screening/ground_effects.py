"""Effects of the ground and the feet, which are not torques along a motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.effects import OnGround, effect_named, kinds, places
from workbench.models import AppliedEffect

from ..data import Data
from ..hypothesis import applied_effect
from .candidate import Candidate
from .sensitivity import Linearisation

_MOVED = (-0.01, -0.003, -0.001, 0.001, 0.003, 0.01)  # m, of a foot: values to begin with


def by_runs(linearisation: Linearisation, data: Data) -> list[Candidate]:
    """Return candidates of ground contact and foot position, from measured forces, by simulation.

    They are no torque along a motion. Where forces were not recorded, these effects are in
    `unobservable_effects`.
    """
    model = linearisation.model
    tried = [
        (key, *start)
        for key in places(model)
        if data.replay.needs_runs(effect_named(key.effect))
        for start in _starts(key, linearisation)
    ]
    models = []
    for key, coefficients, shape in tried:
        values = effect_named(key.effect).parameters.to_values(coefficients, shape)
        models.append(model.with_effect(applied_effect(model, AppliedEffect(key), values)))
    squares = [data.mean_squares(runs) for runs in data.run(models)] if models else []
    part = data.tests_on_holdout
    test_loss = [data.objective(data.pool(s, part)) if np.isfinite(s).all() else np.inf for s in squares]
    best: dict[EffectKey, Candidate] = {}
    for (key, coefficients, shape), left in sorted(zip(tried, test_loss, strict=True), key=lambda x: -x[1]):
        best[key] = Candidate(key, coefficients, shape, left)
    return list(best.values())


def _starts(key: EffectKey, linearisation: Linearisation) -> list[tuple[np.ndarray, Mapping[str, float]]]:
    """Return starting coefficients and shapes; none if the feet show nothing of the effect."""
    effect = effect_named(key.effect)
    if isinstance(effect, OnGround):
        shapes = effect.initial_values(linearisation.fitted_motions)
        return [(np.zeros(0), shape) for shape in shapes]
    return [(np.array([value]), {}) for value in _MOVED]


def unobservable_effects(linearisation: Linearisation) -> list[EffectKey]:
    """Return effects that this kind of replay, or the recorded ground forces, cannot show."""
    out, replay = [], linearisation.data.replay
    for key in places(linearisation.model):
        effect = effect_named(key.effect)
        # what shifts commands or readings is no torque, which is all that a measured motion tells
        along = not replay.simulates and effect.stage not in kinds.TORQUES
        untouched = replay.needs_runs(effect) and not _starts(key, linearisation)
        if along or untouched or not replay.shows(key.effect):
            out.append(key)
    return out
