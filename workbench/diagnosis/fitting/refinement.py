"""From a candidate to a final fit: replaced special cases, sliding speed of friction, needless effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds
from workbench.models import AppliedEffect, Placement, structural_effect

from ..data import Data
from ..hypothesis import Fit, Hypothesis, applied_effect
from ..loss import test_noise_floor
from ..policy import POLICY
from ..screening.candidate import Candidate
from ..screening.sensitivity import Linearisation, combine
from .fit import FINE_TOLERANCE, fit, values_of
from .free_starts import with_free_starts
from .uncertainty import moved_apart, widened

_SLIDING = (0.0005, 0.003, 0.01, 0.03)  # rad/s
_ROUNDS = 5  # of a last fit, at most


def with_candidate(linearisation: Linearisation, candidate: Candidate, current: Fit) -> Hypothesis:
    """Return the current model with a candidate, which replaces its special cases in the same place."""
    effect = effect_named(candidate.key.effect)
    base, free = current.hypothesis.base, current.hypothesis.free
    free = tuple(
        applied_effect(linearisation.model, a, {**a.values, **candidate.beside.get(a.key, {})}) for a in free
    )
    if kinds.free_parameters(effect, linearisation.model) == 0:
        added = structural_effect(effect.name, linearisation.model.linkage)
        return Hypothesis(base, free, (*current.hypothesis.parameter_free, added))
    coefficients, shape = candidate.coefficients, candidate.shape
    given_up = [a for a in free if contains(candidate.key, a.key)]
    if given_up and len(coefficients):
        linear, _ = linearisation.columns(candidate.key, shape)
        target = combine(
            [*linear, *(linearisation.total(a, a.values) for a in given_up)],
            [*coefficients, *(1.0 for _ in given_up)],
        )
        x = np.stack([np.concatenate([t.ravel() for t in c.torque]) for c in linear], axis=1)
        y = np.concatenate([t.ravel() for t in target.torque])
        coefficients = np.linalg.lstsq(x, y, rcond=None)[0]
        place = Placement.of(linearisation.model, candidate.key)
        lower, _ = effect.parameters.bounds(linearisation.model, place, shape)
        coefficients = np.maximum(coefficients, lower)
    values, base = effect.parameters.to_values(coefficients, shape), effect.parameters.stated(base, shape)
    added = applied_effect(linearisation.model, AppliedEffect(candidate.key), values)
    return Hypothesis(
        base, (*(a for a in free if a not in given_up), added), current.hypothesis.parameter_free
    )


def with_candidates(linearisation: Linearisation, chosen: Sequence[Candidate], current: Fit) -> Hypothesis:
    """Return the current model with several candidates, added one at a time by `with_candidate`."""
    for candidate in chosen:
        current = replace(current, hypothesis=with_candidate(linearisation, candidate, current))
    return current.hypothesis


def tune_sliding_speed(found: Fit, data: Data, floor: float) -> Fit:
    """Return the fit with its sliding speed tuned on a grid, if the residual could be due to it.

    The sliding speed [rad/s] is a property of the contact, not of an effect. The grid is evaluated on the
    most informative recordings; how far parameters move between grid points widens their intervals.
    """
    dry = any(kinds.is_dry(effect_named(a.key.effect)) for a in found.hypothesis.free)
    if (
        not dry
        or found.training_loss < POLICY.noise_slack * floor
        or found.training_loss > POLICY.onset_to * floor
    ):
        return found

    def at(speed: float) -> Hypothesis:
        return replace(found.hypothesis, base=replace(found.hypothesis.base, sliding_speed=speed))

    some = data.part(data.most_informative(found.mean_squares, POLICY.informative_share))
    best = int(np.argmin(values_of([at(speed) for speed in _SLIDING], some)))
    chosen = fit([at(_SLIDING[best])], data, iterations=2)[0]
    if chosen is None or chosen.training_loss >= found.training_loss:
        return found
    around = [k for k in (best - 1, best + 1) if 0 <= k < len(_SLIDING)]
    own, *others = fit([at(_SLIDING[k]) for k in (best, *around)], some, iterations=2)
    return chosen if own is None else moved_apart(chosen, own, [o for o in others if o is not None])


def converged(found: Fit, data: Data) -> Fit:
    """Return the same effects, fitted until converged.

    A later effect must not win by what an unfinished fit had still to gain.
    """
    if not found.hypothesis.free or found.hypothesis.diverges:
        return found
    for _ in range(_ROUNDS):
        better = fit([found.hypothesis], data, iterations=4, enough=FINE_TOLERANCE)[0]
        if better is None or better.training_loss > found.training_loss:
            break
        still_falling = better.training_loss < (1.0 - POLICY.tie) * found.training_loss
        found = widened(better, found)
        if not still_falling:
            break
    return with_free_starts(found, data)


def prune(found: Fit, added: EffectKey, data: Data, current: Fit) -> tuple[Fit, tuple[EffectKey, ...]]:
    """Return the fit without effects that the new one made needless, and the keys of those.

    An effect is dropped where the test loss stays within a tie, or, at the noise floor, the training loss.
    """
    slack, noise = 1.0 + POLICY.drop_ties * POLICY.tie, POLICY.drop_in_noise * test_noise_floor(data)
    dropped: tuple[EffectKey, ...] = ()
    while True:
        rest = [a for a in found.hypothesis.free if a.key != added]
        if not rest:
            return found, dropped
        fits = fit([found.hypothesis.without(a.key) for a in rest], data, iterations=3)
        options = [(f.test_loss, a.key, f) for a, f in zip(rest, fits, strict=True) if f is not None]
        options = [
            (test_loss, key, f)
            for test_loss, key, f in options
            if test_loss < current.test_loss
            and (
                test_loss <= found.test_loss * slack
                or (test_loss < noise and f.training_loss <= found.training_loss * slack)
            )
        ]
        if not options:
            return found, dropped
        _, key, found = min(options, key=lambda o: o[0])
        dropped = (*dropped, key)
