"""Effects that follow the curve of another law: the data want less than nothing of one of them.

Friction that grows with the cube of speed is followed a long way by quadratic drag with less damping. Where
the model has not so much damping to be taken off, no machine has these numbers.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds
from workbench.models import AppliedEffect

from ..policy import POLICY
from ..screening.equations import Entry
from ..screening.torque_regression import Chosen, Regression


def imitations(regression: Regression, chosen: Chosen, found: Collection[EffectKey]) -> frozenset[EffectKey]:
    """Return effects of the same quantities of which the data want one clearly beyond a physical bound.

    So they may of a basic effect of these quantities that was not chosen. A basic effect that is alone there
    is as small as it can be, none, and imitates nothing; another one has a cause that no machine has.

    Args:
        regression: from which they were selected.
        chosen: what was selected.
        found: of it what was fitted.
    """
    here = tuple(e for e in chosen if e.key in found)
    laws = {frozenset(e.key for e in here if _of_one_law(e.key, first.key)) for first in here}
    return frozenset(
        key
        for law in laws
        if (len(law) > 1 or not all(effect_named(k.effect).search.basic for k in law))
        and _wants_more(law, here, regression)
        for key in law
    )


def imitate_another_law(added: Sequence[AppliedEffect], regression: Regression) -> bool:
    """Return whether some of the effects that were found one by one follow the curve of another law.

    Args:
        added: all of them, as fitted.
        regression: of all effects along the measured motion, from the same unchanged model.
    """
    chosen: Chosen = ()
    for applied in added:
        shapes = [e for e in regression.entries if e.key == applied.key]
        if shapes:
            best = min(shapes, key=lambda e: float(regression.left((*chosen, e)).sum()))
            chosen = (*chosen, best)
    return bool(imitations(regression, chosen, {a.key for a in added}))


def _wants_more(law: frozenset[EffectKey], chosen: Chosen, regression: Regression) -> bool:
    """Return whether an effect of a law, or a basic one beside it, goes clearly beyond its bounds without
    them.
    """
    basic = [
        e
        for e in regression.entries
        if effect_named(e.key.effect).search.basic
        and all(_of_one_law(e.key, k) and e.key != k and not contains(k, e.key) for k in law)
    ]
    asked = [(e, chosen) for e in chosen if e.key in law] + [(e, (*chosen, e)) for e in basic]
    return any(_goes_beyond(entry, among, regression) for entry, among in asked)


def _goes_beyond(entry: Entry, chosen: Chosen, regression: Regression) -> bool:
    """Return whether an effect, solved beside the others without its bounds, goes clearly beyond them."""
    low, high = regression.limits[entry]
    start = sum(len(e.linear) for e in chosen[: chosen.index(entry)])
    place = slice(start, start + len(low))
    bounded = regression.solved(chosen).coefficients[place]
    if ((low < bounded) & (bounded < high)).all():
        return False  # a bound that holds nothing back changes nothing
    free = regression.without_bounds(entry).solved(chosen)
    own, doubts = free.coefficients[place], POLICY.significant * free.deviations[place]
    return bool(((own < low - doubts) | (own > high + doubts)).any())


def _of_one_law(key: EffectKey, other: EffectKey) -> bool:
    """Return whether two effects are one, or torques of the same quantities in one place."""
    own, its = (kinds.depends_on(effect_named(k.effect)) for k in (key, other))
    beside = (key.axis, key.location) == (other.axis, other.location)
    return key == other or (beside and bool(own) and own == its)
