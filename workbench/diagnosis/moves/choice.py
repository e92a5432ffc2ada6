"""The choice among accepted explanations, and how much worse the others are (loss ratios)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds

from ..acceptance import at_noise_floor
from ..data import Data
from ..hypothesis import Fit
from ..loss import test_noise_floor, training_noise_floor
from ..policy import POLICY
from ..screening.candidate import Candidate

#: An effect in a place that was simulated, with its fit.
Explanation = tuple[Candidate, Fit]
#: An effect with what is left where it explains the data.
EffectLoss = tuple[EffectKey, float]
_T = TypeVar("_T")


def choose(
    helpful: list[Explanation],
    parameter_free: Sequence[Candidate],
    before: float,
    data: Data,
) -> tuple[Candidate, Fit, tuple[EffectKey, ...]]:
    """Return the best explanation and those indistinguishable from it; among equals, the one with fewest
    parameters.

    Inertia, damping and Coulomb friction go before others that explain somewhat more.
    """
    floor = test_noise_floor(data)
    helpful = [cf for cf in helpful if not _refined(cf, helpful, data)]

    def cost(one: Explanation) -> tuple[int, int, bool]:
        (c, f), effect = one, effect_named(one[0].key.effect)
        free = 0 if c in parameter_free else f.hypothesis.size  # of the form that was fitted
        return free, kinds.tier_of(effect), kinds.diverges(effect)

    known = [(c, f) for c, f in helpful if c in parameter_free]
    done = [(c, f) for c, f in helpful if at_noise_floor(f, data)]
    leading = min(helpful, key=lambda cf: cf[1].test_loss)
    top, most = leading[0], leading[1].test_loss

    def only_form(c: Candidate) -> bool:
        """Whether the best explanation is a refinement of this one, which a new fit might not find again."""
        return contains(top.key, c.key) and len(effect_named(top.key.effect).search.contains) == 1

    basic = [
        (c, f)
        for c, f in helpful
        if effect_named(c.key.effect).search.basic
        and cost((c, f)) <= cost(leading)
        and before - f.test_loss > POLICY.basic_share * (before - most)
        and not (most < POLICY.near_noise * floor and f.test_loss > POLICY.far_worse * most)
        and not (only_form(c) and f.test_loss - floor > POLICY.far_worse * max(most - floor, 0.0))
    ]
    pool = known or done or basic or helpful
    best = min(f.test_loss for _, f in pool)
    tied = [(c, f) for c, f in pool if f.test_loss <= best * (1.0 + POLICY.tie)]
    candidate, found = min(tied, key=lambda cf: (cost(cf), cf[1].test_loss))
    # every candidate that fits as well is indistinguishable, unless it merely contains the choice
    indistinguishable = tuple(
        c.key
        for c, f in sorted(helpful, key=lambda cf: cf[1].test_loss)
        if c is not candidate
        and f.test_loss <= found.test_loss * (1.0 + POLICY.tie)
        and not contains(c.key, candidate.key)
        and c not in parameter_free
    )
    return candidate, found, indistinguishable


def worse_by(one: Fit, found: Fit) -> float:
    """Return how many times as much one fit leaves as another, of fitted or of held-out data, the larger."""
    pairs = (one.test_loss, found.test_loss), (one.training_loss, found.training_loss)
    return max(left / max(own, 1e-12) for left, own in pairs)


def _refined(one: Explanation, all_: Sequence[Explanation], data: Data) -> bool:
    """Return whether a refinement explains training error that this one leaves, at the same test loss."""
    floor, (special, found) = training_noise_floor(data), one
    return found.training_loss > POLICY.near_noise * floor and any(
        contains(c.key, special.key)
        and f.test_loss < POLICY.test_blind * found.test_loss
        and f.training_loss < POLICY.near_noise * floor
        and found.training_loss - floor > POLICY.far_worse * (f.training_loss - floor)
        for c, f in all_
    )


def simplest_first(found: Sequence[tuple[_T, Fit]], data: Data, worth: float) -> list[tuple[_T, Fit]]:
    """Return explanations by test loss; those that tie with the best are sorted by number of parameters.

    `worth`: share of the excess that more parameters have to remove to be better at all.
    """
    floor = test_noise_floor(data)
    least = min((f.test_loss for _, f in found), default=0.0)
    enough = max((1.0 + POLICY.tie) * least, floor + (least - floor) / (1.0 - worth))

    def rank(one: tuple[_T, Fit]) -> tuple[bool, int, float]:
        found = one[1]
        worse = found.test_loss > enough and not at_noise_floor(found, data)
        return worse, 0 if worse else found.hypothesis.size, found.test_loss

    return sorted(found, key=rank)


def loss_ratios(key: EffectKey, test_loss: float, others: Iterable[EffectLoss]) -> tuple[EffectLoss, ...]:
    """Return test losses of other explanations divided by that of one, smallest first.

    Forms of the same cause are left out.
    """
    apart = ((k, left / max(test_loss, 1e-12)) for k, left in others if not same_cause(k, key))
    return tuple(sorted(apart, key=lambda kl: kl[1]))


def same_cause(one: EffectKey, other: EffectKey) -> bool:
    """Return whether two effects are the same, or two forms of the same cause."""
    return one.same_place(other) or contains(one, other) or contains(other, one)


def may_stand_together(one: EffectKey, other: EffectKey) -> bool:
    """Whether two effects are neither two forms of one cause nor dry frictions that share a stiction."""
    if one == other or contains(one, other) or contains(other, one):
        return False
    return not (
        kinds.is_dry(effect_named(one.effect))
        and kinds.is_dry(effect_named(other.effect))
        and one.axis == other.axis
    )
