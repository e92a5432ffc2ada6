"""Forward selection with removal on the torque along measured motions, for many effects on many axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations, groupby

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds

from ..moves.choice import may_stand_together
from ..policy import POLICY
from .equations import Entry
from .forms import in_best_form, reformed
from .selection import (
    Selection,
    are_basic,
    cost_of,
    gain_of,
    least_gain,
    loss_without,
    promised_gain,
    selection_of,
    with_new,
)
from .torque_regression import Chosen, Regression, Solution


def selected(regression: Regression) -> Selection:
    """Return the selection: effects are added while one removes enough on an axis, and needless ones are
    removed.

    Inertia, damping and Coulomb friction at one place also come in twos and threes: alone, friction takes up
    the damping that is missing beside it. Of what explains nearly as much as the best, the fewest parameters
    come first. Where drives of one make have the same alike, many others together explain it too. If it takes
    fewer of these beside that, that is tried as a beginning, and kept if it takes fewer parameters.
    """
    first = _selected_from((), regression)
    good = [first]
    for group in _one_make(regression):
        of_these = grown(selection_of(group, regression), regression, first.chosen)
        if cost_of(of_these.chosen) < cost_of(first.chosen):
            other = _selected_from(group, regression)
            # what the others explain beside it is held to what any later effects are held to
            if (gain_of(first.solution, other.solution, regression) < POLICY.later_gain).all():
                good.append(other)
    return min(good, key=lambda s: (cost_of(s.chosen), float(s.solution.test_loss.sum())))


def _selected_from(start: Chosen, regression: Regression) -> Selection:
    now, visited = selection_of(start, regression), set[frozenset[Entry]]()
    while frozenset(now.chosen) not in visited:
        visited.add(frozenset(now.chosen))
        more = grown(now, regression, regression.entries)
        now = _one_for_several(without_needless(reformed(more, regression), regression), regression)
        if set(now.chosen) == set(more.chosen):
            break
    return now


def _one_make(regression: Regression) -> list[Chosen]:
    """Return one linear effect at all drives, for each effect that drives of one design may share."""
    model = regression.linearisation.model
    out: dict[str, dict[str, Entry]] = {}
    for entry in (*regression.entries, *regression.gains):
        key, effect = entry.key, effect_named(entry.key.effect)
        if key.axis and key.location == "actuator" and not entry.shape and kinds.shared_by_design(effect):
            out.setdefault(key.effect, {})[key.axis] = entry
    return [tuple(own.values()) for own in out.values() if 1 < len(own) == len(model.driven)]


def grown(now: Selection, regression: Regression, entries: Chosen) -> Selection:
    """Return the selection with all of some effects that help, added one at a time."""
    proposals = [*((e,) for e in entries if not e.is_extended), *_sets_of_basics(entries)]
    gains: dict[Chosen, np.ndarray] = {}
    while True:
        proposals += [p for p in _more_of_a_kind(now.chosen, regression) if p not in proposals]
        for new in proposals:
            if new not in gains and fits_in(new, now.chosen):
                gains[new] = _gain(new, now, regression)
        helpful = {p: g for p, g in gains.items() if (g > least_gain(p, regression)).any() and g.sum() > 0.0}
        new = _next(helpful)
        while new and _only_refines(new, now, regression):
            proposals.remove(new)  # whatever comes on other axes
            del helpful[new], gains[new]
            new = _next(helpful)
        if new is None:
            return now
        new = in_best_form(new, now.chosen, regression)
        now = selection_of(with_new(now.chosen, new), regression)
        # what acts on none of its axes gains as before
        acts = frozenset().union(*map(regression.axes_of, new))
        gains = {
            p: g
            for p, g in gains.items()
            if not any(acts & regression.axes_of(e) for e in p) and fits_in(p, new)
        }


def _gain(new: Chosen, now: Selection, regression: Regression) -> np.ndarray:
    """Return the gain of some new effects on each axis (n,); zero if the fit itself promises too little."""
    chosen = with_new(now.chosen, new)
    promised = promised_gain(chosen, now, regression)
    if not (promised > POLICY.screened_gain * least_gain(new, regression)).any():
        return np.zeros_like(promised)
    found = regression.solved(chosen)
    gain = gain_of(found, now.solution, regression)
    return np.zeros_like(gain) if _is_small(new, found) else gain


def _is_small(new: Chosen, found: Solution) -> bool:
    """Whether a further effect of a kind is so small that it may only correct the shape of earlier ones."""
    (*_, last) = new
    size = float(np.linalg.norm(found.coefficients[len(found.coefficients) - len(last.linear) :]))
    return last.key.copy > 1 and size * last.strength < POLICY.small_effect


def _more_of_a_kind(chosen: Chosen, regression: Regression) -> list[Chosen]:
    """Return a further effect beside each one that may repeat, such as another harmonic."""
    out = []
    for last in chosen:
        kin = [e for e in chosen if e.key.same_place(last.key)]
        if last is kin[-1]:
            out += [(e,) for e in regression.copies(kin)]
    return out


def _next(helpful: Mapping[Chosen, np.ndarray]) -> Chosen | None:
    """Return, for the axis that gains most, the effects with fewest parameters that gain nearly as much.

    Basic effects go before others that gain somewhat more.
    """
    if not helpful:
        return None
    top = max(helpful.values(), key=lambda g: g.max())
    axis, most = int(top.argmax()), float(top.max())
    basic = [p for p, g in helpful.items() if are_basic(p) and g[axis] > POLICY.basic_share * most]
    pool = basic or list(helpful)
    most = max(helpful[p][axis] for p in pool)
    near = [p for p in pool if helpful[p][axis] >= POLICY.explained * most]
    return min(near, key=lambda p: (cost_of(p), -helpful[p][axis]))


def _only_refines(new: Chosen, now: Selection, regression: Regression) -> bool:
    """Return whether special cases already present explain nearly all that an effect explains.

    Where it leads to the noise it is more than they are. Friction that sets in softly is still Coulomb
    friction as long as the rest has other causes.
    """
    parts = [e for e in now.chosen if any(contains(n.key, e.key) for n in new)]
    own = [k for k in regression.own if any(contains(n.key, k) for n in new)]
    if not parts and not own:
        return False
    chosen = with_new(now.chosen, new)
    bare = regression.solved(tuple(e for e in now.chosen if e not in parts), without=own)
    found = regression.solved(chosen)
    whole, special = (gain_of(s, bare, regression) for s in (found, now.solution))
    axis = int(whole.argmax())
    at_noise = found.test_loss[axis] < POLICY.at_noise * regression.test_floor[axis]
    return bool(special[axis] > POLICY.basic_share * whole[axis] and not at_noise)


def fits_in(new: Chosen, chosen: Chosen) -> bool:
    """Return whether none of some new effects is already present, in this or another form."""
    return all(
        _may_come_beside(n.key, e.key)
        for n in (m for each in new for m in each.members)
        for e in (m for each in chosen for m in each.members)
        if n.key.axis == e.key.axis or None in (n.key.axis, e.key.axis)
    )


@cache
def _may_come_beside(new: EffectKey, there: EffectKey) -> bool:
    """Return whether a new effect is not there yet in this or another form; a more general form may come."""
    if new == there or contains(there, new):
        return False
    return contains(new, there) or may_stand_together(new, there)


def _sets_of_basics(entries: Sequence[Entry]) -> list[Chosen]:
    """Return sets of two and three basic effects in one place."""
    basic = [e for e in entries if effect_named(e.key.effect).search.basic and e.key.axis is not None]
    basic.sort(key=lambda e: (str(e.key.axis), e.key.location))
    places = [list(own) for _, own in groupby(basic, lambda e: (e.key.axis, e.key.location))]
    return [s for own in places for size in (2, 3) for s in combinations(own, size)]


def _one_for_several(now: Selection, regression: Regression) -> Selection:
    """Return the selection with one shared effect in place of the same effect on several axes, if it explains
    as much.

    A mass that several drives carry is a rotor of each of them, where nothing turns and nothing is lifted.
    """
    for effect in dict.fromkeys(e.key.effect for e in now.chosen if e.key.axis is not None):
        several = tuple(e for e in now.chosen if e.key.effect == effect)
        axes = frozenset().union(*map(regression.axes_of, several))
        others = tuple(e for e in now.chosen if e not in several)
        tried = [
            selection_of((*others, e), regression)
            for e in regression.entries
            if e.key.effect != effect and axes <= regression.axes_of(e)
            and cost_of((e,)) < cost_of(several) and fits_in((e,), others)
        ] if len(several) > 1 else []  # fmt: skip
        good = [t for t in tried if _is_as_good(t.solution, now.solution)]
        now = min(good, key=lambda t: float(t.solution.test_loss.sum()), default=now)
    return now


def _is_as_good(one: Solution, other: Solution) -> bool:
    """Return whether it leaves no more than the other on any axis, up to a tie."""
    pairs = (one.test_loss, other.test_loss), (one.validated, other.validated)
    return all(bool(np.all(a <= (1.0 + POLICY.tie) * b)) for a, b in pairs)


def without_needless(now: Selection, regression: Regression) -> Selection:
    """The selection without effects that the others made needless; the most needless is removed first."""
    while now.chosen:
        rest = [tuple(e for e in now.chosen if e is not out) for out in now.chosen]
        fewer = [selection_of(r, regression) for r in rest]
        lost = [loss_without((out,), f, now, regression) for out, f in zip(now.chosen, fewer, strict=True)]
        k = int(np.argmin(lost))
        if lost[k] > 1.0:
            break
        now = fewer[k]
    return now
