"""The fit of selected effects along the measured motion: of all of them, and of those that are certain."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import effect_named, kinds
from workbench.models import AppliedEffect

from ..adequacy.adequacy import Adequacy, adequacies
from ..adequacy.imitations import imitations
from ..adequacy.link_errors import several_wrong
from ..adequacy.strangers import without_strangers
from ..data import Data, gather_along
from ..fitting.fit import fit
from ..fitting.refinement import with_candidates
from ..hypothesis import Fit, Hypothesis
from ..node import is_consistent
from ..policy import POLICY
from ..problem import evaluated, starting_fit
from ..screening.alike import in_common
from ..screening.rivals import rivals_of
from ..screening.selection import Selection
from ..screening.stepwise_regression import selected
from ..screening.torque_columns import regression_of
from ..screening.torque_regression import Regression
from ..significance import is_significant, significance, told_by_motion

_BACKFITS = 2  # of the unknown and the certain in turns; a third changes less than the noise does


@dataclass(frozen=True)
class Certain:
    """The effects selected along the measured motion, and those of them that are certain.

    Attributes:
        regression: from which it was selected.
        chosen: all that was selected.
        whole: its fit.
        known: how certain each effect is that is certain although something else is missing.
        apart: whether values are those where what is unknown is set apart.
        by_links: the share that errors of all links explain, where some effects only come close to these;
            otherwise 0.
    """

    regression: Regression
    chosen: Selection
    whole: Fit
    known: Mapping[EffectKey, Adequacy]
    apart: bool = False
    by_links: float = 0.0


def certain_of(
    regression: Regression,
    start: Fit,
    data: Data,
    *,
    whatever_is_left: bool = False,
    bent: Container[str | None] = (),
) -> Certain | None:
    """Return the selected effects and the certain ones; None if no effect helps.

    Where noise explains the rest it is only asked whether they stand for numbers of links, but for
    `whatever_is_left`; or if there are axes that are `bent`: what follows their positions is not certain.
    """
    chosen = in_common(selected(regression), regression)
    whole = fit_of_selection(regression, chosen, start, data)
    if whole is None:
        return None
    errors, imitating = several_wrong(whole.hypothesis.free, regression, chosen.chosen, data)
    if is_consistent(data, whole.mean_squares) and not (errors or whatever_is_left or bent):
        return Certain(regression, chosen, whole, {})
    others = like_others(regression, chosen) | imitations(regression, chosen.chosen, whole.hypothesis.keys)
    found = adequacies(whole, regression, data)
    others |= {k for k in found if k.axis in bent and "speed" not in kinds.depends_on(effect_named(k.effect))}
    known = {k: a for k, a in found.items() if a.is_adequate and k not in others | imitating}
    return Certain(regression, chosen, whole, known, by_links=errors.share if errors else 0.0)


def freed_of(start: Fit, rest: Sequence[Recording], data: Data, seed: int) -> tuple[Data, Fit]:
    """Return recordings without a removed component, and the unchanged model along their motion."""
    model = start.hypothesis.model
    freed, runs = gather_along(model, rest, data.training, seed)
    return freed, starting_fit(model, freed, runs.clean)


def like_others(regression: Regression, chosen: Selection) -> set[EffectKey]:
    """Effects of the whole machine that others explain as well, as masses of links explain a moved body."""
    return {
        entry.key
        for entry in chosen.chosen
        if entry.key.axis is None and rivals_of(regression, chosen.chosen, entry)[1]
    }


def fit_of_selection(regression: Regression, chosen: Selection, current: Fit, data: Data) -> Fit | None:
    """Return the fit of all selected effects that are significant and identified by the motions.

    What a fit drew out of the reach of these goes first. Of two that trade with each other neither is clear,
    until one is out: of each axis the least clear goes first. What joints of one design share has one size.
    """
    if not chosen.chosen:
        return None
    candidates = chosen.candidates()
    found = fit([with_candidates(regression.linearisation, candidates, current)], data)[0]
    while found is not None:
        found = replace(found, hypothesis=_with_shared_sizes(found.hypothesis, chosen.shared))
        told = tuple(a for a in found.hypothesis.free if told_by_motion(regression.linearisation, a, found))
        if len(told) < len(found.hypothesis.free):
            found = fit([replace(found.hypothesis, free=told)], data)[0] if told else None
            continue
        doubted: dict[str | None, AppliedEffect] = {}
        for applied in (a for a in found.hypothesis.free if not is_significant(a)):
            weakest = doubted.setdefault(applied.key.axis, applied)
            if significance(applied) < significance(weakest):
                doubted[applied.key.axis] = applied
        if not doubted:
            break
        clear = tuple(a for a in found.hypothesis.free if doubted.get(a.key.axis) is not a)
        found = fit([replace(found.hypothesis, free=clear)], data)[0] if clear else None
    if found is None or not chosen.shared:
        return found
    return evaluated(found.hypothesis, data.run([found.hypothesis.model])[0], data)


def _with_shared_sizes(hypothesis: Hypothesis, shared: Sequence[frozenset[EffectKey]]) -> Hypothesis:
    """Return the hypothesis in which shared effects have the mean of their sizes, weighted by variances.

    If they scatter more than their deviations say, the deviation of the mean grows with that.
    """
    values = {a.key: a for a in hypothesis.free}
    for keys in shared:
        there = [values[key] for key in values if key in keys]
        if len(there) < 2:
            continue
        (name,) = there[0].parameters
        each = np.array([(a.parameters[name].value, a.parameters[name].std) for a in there])
        weights = 1.0 / np.maximum(each[:, 1], 1e-12) ** 2
        mean = float(np.average(each[:, 0], weights=weights))
        scatter = np.sum(weights * (each[:, 0] - mean) ** 2) / (len(there) - 1)
        std = float(np.sqrt(max(1.0, scatter) / weights.sum()))
        for a in there:
            own = replace(a.parameters[name], value=mean, std=std)
            values[a.key] = AppliedEffect(a.key, {name: own})
    return replace(hypothesis, free=tuple(values.values()))


def certain_only(whole: Fit, sure: Mapping[EffectKey, Adequacy], data: Data) -> Fit | None:
    """Return the certain effects with the values they have beside all others; deviations also cover free
    functions.

    Without the others they would stand for a part of these.
    """
    free = tuple(_with_spread(a, sure) for a in whole.hypothesis.free if a.key in sure)
    return _clear_of(replace(whole.hypothesis, free=free), data)


def _clear_of(hypothesis: Hypothesis, data: Data) -> Fit | None:
    """Return what is significant of a hypothesis: a part of a law that is certain as a whole may be none."""
    clear = replace(hypothesis, free=tuple(a for a in hypothesis.free if is_significant(a)))
    return evaluated(clear, data.run([clear.model])[0], data) if clear.free else None


def beside_strangers(
    whole: Fit, named: Fit, sure: Mapping[EffectKey, Adequacy], start: Fit, data: Data, seed: int
) -> Fit | None:
    """Return the certain effects, with values fitted after the part that no effect explains was removed.

    A tone that no effect explains leaves no room for the damping of its axis, and Coulomb friction takes that
    up as well. Unknown and certain torques are fitted in turns.

    Args:
        whole: all that was selected.
        named: of it what is certain, which stays the same.
        sure: how certain each is.
        start: without any of them, along the measured motion.
        data: of that motion.
        seed: of the noise simulations.
    """
    found = whole
    for _ in range(_BACKFITS):
        rest = without_strangers(found, data, sure)
        if rest is None:
            break
        freed, begun = freed_of(start, rest, data, seed)
        regression = regression_of(begun, freed)
        again = fit_of_selection(regression, in_common(selected(regression), regression), begun, freed)
        if again is None:
            break
        found = evaluated(again.hypothesis, data.run([again.hypothesis.model])[0], data)
    if found is whole:
        return named
    now = {a.key: _with_spread(a, sure) for a in found.hypothesis.free if a.key in sure}
    free = tuple(now.get(a.key, a) for a in named.hypothesis.free)
    return _clear_of(replace(named.hypothesis, free=free), data)


def _with_spread(applied: AppliedEffect, sure: Mapping[EffectKey, Adequacy]) -> AppliedEffect:
    """Return an effect with deviations that cover how its size changes beside free functions, and along the
    motion; the blocks that are left out differ in that too.

    What does not grow with the size, as the order of a ripple, does not vary with it.
    """
    known, parameters = sure[applied.key], effect_named(applied.key.effect).parameters
    spread = POLICY.rival_deviation * known.spread
    coefficients, shape = parameters.to_coefficients(applied.values)
    doubled = parameters.to_values(2.0 * coefficients, shape)
    size = {name: abs(doubled.get(name, e.value) - e.value) for name, e in applied.parameters.items()}
    return AppliedEffect(
        applied.key,
        {
            name: replace(e, std=float(max(np.hypot(e.std, spread * e.value), known.variation * size[name])))
            for name, e in applied.parameters.items()
        },
    )
