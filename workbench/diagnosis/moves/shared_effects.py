"""The move that adds one effect to all axes: joints of one design usually share their effects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from workbench.core import EffectKey
from workbench.effects import EFFECTS, SignalStage, kinds
from workbench.models import AppliedEffect
from workbench.report.wording import any_of, effect_name

from ..acceptance import explains_most, holdout_insensitive, improves_an_axis, near_noise_floor
from ..data import Data
from ..fitting.fit import fit, successive_halving
from ..fitting.refinement import converged, tune_sliding_speed, with_candidates
from ..hypothesis import Fit
from ..loss import rescored, test_noise_floor
from ..policy import POLICY
from ..problem import Problem
from ..removed_share import removed_shares
from ..screening.candidate import Candidate
from ..screening.equations import Entry, Equations, equations
from ..screening.screen import entries_of
from ..screening.sensitivity import Linearisation
from ..search_result import AcceptedStep, steps_through
from ..significance import significance
from .choice import loss_ratios, simplest_first
from .sets import is_sound, solved_together

# What a plain model of drives leaves out together: sets that are tried beside each effect by itself.
_BASIC = sorted((e for e in EFFECTS if e.search.basic and e.locations), key=lambda e: e.name)
_FRICTION = tuple(e.name for e in _BASIC if e.stage is SignalStage.FRICTION)
_DRIVES = (*_FRICTION, *(e.name for e in _BASIC if e.stage is not SignalStage.FRICTION))


def shared_effects(problem: Problem) -> tuple[AcceptedStep, ...]:
    """Return steps with one effect (or a few that belong together) on every axis that needs it.

    Where each of many axes has a share of the error, no single effect explains enough by itself. Axes that
    fit as well without are left out again.

    Returns:
        One step per effect and axis, the largest first; without their own data and runs.
        Empty where nothing explains much.
    """
    linearisation, data, start = problem.linearisation, problem.data, problem.start
    if linearisation.model.size < 2:
        return ()
    problem.progress("trying one cause on every axis")
    whole = problem.linear.equations if problem.linear else None
    if whole is None:
        columns, entries = entries_of(linearisation)
        whole = equations(linearisation, [], columns, entries, data)
    if holdout_insensitive(start, data):  # an insensitive holdout cannot test
        data, whole = data.cross_validated(), replace(whole, held_out=None)
        start = rescored(start, data)
    sets = _promising(problem.screened, linearisation, data, start, whole)[: POLICY.sets_simulated]
    if not sets:
        return ()
    told = [any_of([effect_name(name) for name in names], "and") for names, _ in sets]
    problem.progress(f"fitting {'; '.join(told)} on every axis")
    tried = [with_candidates(linearisation, chosen, start) for _, chosen in sets]
    raced, _ = successive_halving(tried, start, data)
    fits = [(names, f) for (names, _), f in zip(sets, raced, strict=True) if f is not None]
    floor = test_noise_floor(data)
    for names, found in simplest_first(fits, data, POLICY.later_gain):
        best = converged(needed(tune_sliding_speed(found, data, floor), data), data)
        if len(best.hypothesis.free) > 1 and is_sound(best, linearisation, data, start):
            others = [(f.hypothesis.free[0].key, f.test_loss) for n, f in fits if _other_causes(n, names)]
            return _steps(best, others, data, start)
    return ()


def _other_causes(names: Sequence[str], than: Sequence[str]) -> bool:
    """Return whether none of some effects is, or refines, one of the others."""
    return not set(names) & {*than, *(e.name for e in EFFECTS if set(e.search.contains) & set(than))}


def needed(whole: Fit, data: Data) -> Fit:
    """Return the fit with only those effects whose removal raises the loss.

    What is least certain goes first, as many at once as do no harm: one by one, a dozen axes with three
    effects each would take hundreds of fits.
    """
    found = whole
    while len(found.hypothesis.free) > 1:
        without = fit([replace(found.hypothesis, free=f) for f in _fewer(found)], data, iterations=3)
        idle = [
            f
            for f in without
            if f is not None
            and not explains_most(whole, f, data)
            and (near_noise_floor(f, data) or not improves_an_axis(whole, f, data))
        ]
        if not idle:
            break
        found = min(idle, key=lambda f: (len(f.hypothesis.free), f.test_loss))
    return found


def _fewer(found: Fit) -> Iterator[tuple[AppliedEffect, ...]]:
    """Return its effects without each of the least certain ones, then without twice as many each time."""
    free = found.hypothesis.free
    certain = {a.key: significance(a) for a in free}
    order = sorted(certain, key=certain.__getitem__)
    out = [{key} for key in order[: POLICY.doubted_singly]]
    out += [set(order[: 2**k]) for k in range(1, len(free)) if 2**k <= len(order) and 2**k < len(free)]
    return (tuple(a for a in free if a.key not in some) for some in out)


def _promising(
    screened: Sequence[Candidate], linearisation: Linearisation, data: Data, start: Fit, whole: Equations
) -> list[tuple[tuple[str, ...], tuple[Candidate, ...]]]:
    """Return sets of effects by their loss in the linearised loop, the best of each kind."""
    at_drives = {
        (c.key.effect, c.key.axis): c
        for c in screened
        if c.key.axis is not None and c.key.location == "actuator" and np.isfinite(c.test_loss)
    }
    floor, excess = test_noise_floor(data), _excess(start, data)
    best: dict[tuple[str, ...], tuple[float, tuple[Candidate, ...]]] = {}
    for option, own in _sets(at_drives, linearisation, whole, excess, start.test_loss):
        gone = (1.0 - POLICY.promising) * sum(excess[a] for a in {e.key.axis for e in own} if a)
        most = floor + max(start.test_loss - floor, 0.0) - gone
        test_loss, chosen = solved_together(own, linearisation, whole)
        if test_loss < min(most, best[option][0] if option in best else np.inf):
            best[option] = test_loss, chosen
    return [(option, chosen) for option, (_, chosen) in sorted(best.items(), key=lambda b: b[1][0])]


def _sets(
    at_drives: Mapping[tuple[str, str], Candidate],
    linearisation: Linearisation,
    whole: Equations,
    excess: Mapping[str, float],
    before: float,
) -> Iterator[tuple[tuple[str, ...], list[Entry]]]:
    """Return sets of one effect on all axes, or on those that show it: each in its best shape, and all with
    the same shape.
    """
    there = {effect for effect, _ in at_drives}
    names = [effect.name for effect in EFFECTS if kinds.shared_by_design(effect) and effect.name in there]
    entries = {
        (e.key.effect, e.key.axis, _shape(e.shape)): e
        for e in whole.entries
        if e.key.location == "actuator" and e.key.axis is not None and e.key.effect in names
    }
    everywhere = set(linearisation.model.driven)
    for option in (*((name,) for name in names), _FRICTION, _DRIVES):
        gains = {a: before - _least(at_drives, option, a) for a in everywhere}
        shown = {a for a in everywhere if gains[a] > POLICY.axis_share * excess[a]}
        for axes in (
            (everywhere, shown) if POLICY.axes_alike <= len(shown) < len(everywhere) else (everywhere,)
        ):
            places = [(n, a) for n in option for a in sorted(axes) if (n, a) in at_drives]
            shaped = [entries.get((n, a, _shape(at_drives[n, a].shape))) for n, a in places]
            own = [e for e in shaped if e is not None]
            if len(own) > 1:
                yield option, own
    for name in names:
        for shape in dict.fromkeys(s for n, _, s in entries if n == name and s):
            alike = [entries[name, a, shape] for a in sorted(everywhere) if (name, a, shape) in entries]
            if len(alike) == len(everywhere):
                yield (name,), alike


def _shape(shape: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    return tuple(sorted(shape.items()))


def _excess(start: Fit, data: Data) -> dict[str, float]:
    """Return the test loss above the noise of each axis (n,)."""
    part = data.tests_on_holdout
    above = np.maximum(data.pool(start.mean_squares, part) - data.least(part), 0.0)
    return dict(zip(data.recordings[0].axes, np.sum(above * data.weight**2, axis=0).tolist(), strict=True))


def _least(candidates: Mapping[tuple[str, str], Candidate], names: Sequence[str], axis: str) -> float:
    """Return the smallest test loss that one of these effects alone would leave on one axis."""
    return min((candidates[n, axis].test_loss for n in names if (n, axis) in candidates), default=np.inf)


def _steps(
    best: Fit, others: Sequence[tuple[EffectKey, float]], data: Data, start: Fit
) -> tuple[AcceptedStep, ...]:
    """Return steps of the effects, the one that explains most by itself first; `others` are alternative
    explanations.
    """
    whole = best.hypothesis
    singles = fit([replace(whole, free=(a,)) for a in whole.free], data, iterations=2)
    left = [np.inf if s is None else s.test_loss for s in singles]
    order = [whole.free[k] for k in np.argsort(left, kind="stable")]
    parts = [replace(whole, free=tuple(order[: k + 1])) for k in range(len(order) - 1)]
    grown = [f for f in fit(parts, data) if f is not None]
    alone = [(a.key, test_loss) for a, test_loss in zip(whole.free, left, strict=True) if test_loss < np.inf]
    ranking = removed_shares(start.test_loss, alone, test_noise_floor(data))
    found, known = [], start.hypothesis.keys
    for result in (*grown, best):
        added = next(a.key for a in order if a.key in result.hypothesis.keys - known)
        known = result.hypothesis.keys
        found.append((added, result))

    def told(key: EffectKey) -> dict[str, Any]:
        return {"ranking": ranking, "loss_ratios": loss_ratios(key, best.test_loss, others)}

    return steps_through(start, found, data, told)
