"""The move that adds one effect to all axes: joints of one design have the same effects."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import EFFECTS, Door, kinds

from ..acceptance import (
    degrades_holdout,
    explains_most,
    holdout_insensitive,
    improves_an_axis,
    near_noise_floor,
)
from ..data import Data
from ..fitting.fit import fit, successive_halving
from ..fitting.refinement import converged, tune_sliding_speed, with_candidates
from ..hypothesis import Fit
from ..loss import rescored, test_noise_floor
from ..policy import POLICY
from ..removed_share import removed_share, removed_shares
from ..screening.screen import Candidate, Entry, equations, judge, limits_of
from ..screening.sensitivity import Linearisation, SensitivityColumn
from ..search_result import AcceptedStep
from ..significance import cancel_each_other, identifiable
from .choice import loss_ratios, simplest_first

# What a plain model of drives leaves out together: sets that are tried beside each effect by itself.
_BASIC = sorted((e for e in EFFECTS if e.search.basic and e.locations), key=lambda e: e.name)
_FRICTION = tuple(e.name for e in _BASIC if e.door is Door.FRICTION)
_DRIVES = (*_FRICTION, *(e.name for e in _BASIC if e.door is not Door.FRICTION))


@dataclass(frozen=True)
class _Fitted:
    """Effects, each on all axes, with their fit."""

    effects: tuple[str, ...]
    fit: Fit


def shared_effects(
    screened: Sequence[Candidate],
    linearisation: Linearisation,
    data: Data,
    start: Fit,
    progress: Callable[[str], None],
) -> tuple[AcceptedStep, ...]:
    """Steps with one effect (or a few that belong together) on all axes that need it.

    Where each of many axes has a share of the error, no single effect explains enough by itself. Axes that
    fit as well without are left out again.

    Args:
        screened: every effect in every place, as a first one.
        linearisation: of the model so far.
        data: its recordings.
        start: the model as it is.
        progress: told what is being done.

    Returns:
        One step an effect and axis, the largest first; without their own data and runs.
        Empty where nothing explains much.
    """
    if linearisation.model.size < 2:
        return ()
    progress("looking for one cause on every axis")
    if holdout_insensitive(start, data):  # an insensitive holdout cannot test
        data = data.cross_validated()
        start = rescored(start, data)
    sets = _promising(screened, linearisation, data, start)[: POLICY.sets_simulated]
    if not sets:
        return ()
    progress(f"fitting {'; '.join(' and '.join(names) for names, _ in sets)} on every axis")
    tried = [with_candidates(linearisation, chosen, start) for _, chosen in sets]
    competed = zip(sets, successive_halving(tried, start, data)[0], strict=True)
    fits = [_Fitted(names, f) for (names, _), f in competed if f is not None]
    floor = test_noise_floor(data)
    for found in simplest_first(fits, data, POLICY.later_gain):
        best = replace(found, fit=converged(needed(tune_sliding_speed(found.fit, data, floor), data), data))
        if len(best.fit.hypothesis.free) < 2 or not explains_most(best.fit, start, data):
            continue
        sound = identifiable(linearisation, best.fit) and not cancel_each_other(linearisation, best.fit)
        if sound and not degrades_holdout(best.fit, start, data):
            return _steps(best, fits, data, start)
    return ()


def needed(whole: Fit, data: Data, doubted: Collection[EffectKey] | None = None) -> Fit:
    """The fit with only those effects whose removal raises the loss.

    `doubted`: the effects to test; by default all.
    """
    found = whole
    while len(found.hypothesis.free) > 1:
        free = found.hypothesis.free
        asked = [a for a in free if doubted is None or a.key in doubted]
        others = [tuple(b for b in free if b is not a) for a in asked]
        without = fit([replace(found.hypothesis, free=rest) for rest in others], data, iterations=3)
        idle = [
            f
            for f in without
            if f is not None
            and not explains_most(whole, f, data)
            and (near_noise_floor(f, data) or not improves_an_axis(whole, f, data))
        ]
        if not idle:
            break
        found = min(idle, key=lambda f: f.test_loss)
    return found


def _promising(
    screened: Sequence[Candidate], linearisation: Linearisation, data: Data, start: Fit
) -> list[tuple[tuple[str, ...], list[Candidate]]]:
    """Sets of effects by their loss on the linearised loop, with the loss of each axis."""
    at_drives = {
        (c.key.effect, c.key.axis): c
        for c in screened
        if c.key.axis is not None and c.key.location == "actuator" and np.isfinite(c.test_loss)
    }
    there = {effect for effect, _ in at_drives}
    names = [effect.name for effect in EFFECTS if kinds.of_a_make(effect) and effect.name in there]
    columns, entries = _columns(linearisation, [c for c in at_drives.values() if c.key.effect in names])
    if not columns:
        return []
    pieces, held_out = equations(linearisation, [], columns, data, start.simulated)
    floor, excess = test_noise_floor(data), _excess(start, data)
    options = (*((name,) for name in names), _FRICTION, _DRIVES)
    everywhere = set(linearisation.model.driven)
    tries = [(option, everywhere) for option in options]
    for option in options:
        gains = {a: start.test_loss - _least(at_drives, option, a) for a in everywhere}
        shown = {a for a in everywhere if gains[a] > POLICY.axis_share * excess[a]}
        if POLICY.axes_alike <= len(shown) < len(everywhere):
            tries.append((option, shown))
    found: list[tuple[float, tuple[str, ...], list[Candidate]]] = []
    for option, axes in tries:
        own = [e for name in option for e in entries if e.key.effect == name and e.key.axis in axes]
        if len(own) < 2:
            continue
        gone = (1.0 - POLICY.promising) * sum(excess[a] for a in axes)
        most = floor + max(start.test_loss - floor, 0.0) - gone
        bounds = [np.concatenate(b) for b in zip(*(limits_of(linearisation, e) for e in own), strict=True)]
        index = [k for e in own for k in e.linear]
        fixed = [e.fixed for e in own if e.fixed is not None]
        test_loss, solution = judge(pieces, held_out, index, fixed, (bounds[0], bounds[1]))
        parts = np.split(solution, np.cumsum([len(e.linear) for e in own])[:-1])
        chosen = [Candidate(e.key, x, e.shape, test_loss) for e, x in zip(own, parts, strict=True)]
        if test_loss < most:
            found.append((test_loss, option, chosen))
    return [(option, chosen) for _, option, chosen in sorted(found, key=lambda f: f[0])]


def _excess(start: Fit, data: Data) -> dict[str, float]:
    """Test loss above the noise, by axis (n,)."""
    part = data.tests_on_holdout
    above = np.maximum(data.pool(start.mean_squares, part) - data.least(part), 0.0)
    return dict(zip(data.recordings[0].axes, np.sum(above * data.weight**2, axis=0).tolist(), strict=True))


def _least(candidates: Mapping[tuple[str, str], Candidate], names: Sequence[str], axis: str) -> float:
    """Test loss that the best of these effects would leave by itself on one axis."""
    return min((candidates[n, axis].test_loss for n in names if (n, axis) in candidates), default=np.inf)


def _columns(
    linearisation: Linearisation, candidates: Sequence[Candidate]
) -> tuple[list[SensitivityColumn], list[Entry]]:
    """Columns of candidates in their best shape, and where they stand."""
    columns: list[SensitivityColumn] = []
    entries: list[Entry] = []
    for c in candidates:
        linear, fixed = linearisation.columns(c.key, c.shape)
        first = len(columns)
        columns += [*linear, *([fixed] if fixed else [])]
        last = first + len(linear)
        entries.append(Entry(c.key, c.shape, list(range(first, last)), last if fixed else None, 1.0))
    return columns, entries


def _steps(best: _Fitted, fits: Sequence[_Fitted], data: Data, start: Fit) -> tuple[AcceptedStep, ...]:
    """Steps of the effects, the one that explains most by itself first."""
    whole = best.fit.hypothesis
    singles = fit([replace(whole, free=(a,)) for a in whole.free], data, iterations=2)
    left = [np.inf if s is None else s.test_loss for s in singles]
    order = [whole.free[k] for k in np.argsort(left, kind="stable")]
    parts = [replace(whole, free=tuple(order[: k + 1])) for k in range(len(order) - 1)]
    grown = [f for f in fit(parts, data) if f is not None]
    floor = test_noise_floor(data)
    alone = [(a.key, test_loss) for a, test_loss in zip(whole.free, left, strict=True) if test_loss < np.inf]
    ranking = removed_shares(start.test_loss, alone, floor)
    forms = set(best.effects) | {e.name for e in EFFECTS if set(e.search.contains) & set(best.effects)}
    instead = [(f.fit.hypothesis.free[0].key, f.fit.test_loss) for f in fits if not set(f.effects) & forms]
    before, steps = start, []
    for result in (*grown, best.fit):
        added = next(a.key for a in order if a.key not in _keys(before) and a.key in _keys(result))
        steps.append(
            AcceptedStep(
                added=added,
                fit=result,
                data=data,
                removed_share=removed_share(before.test_loss, result.test_loss, floor),
                indistinguishable=(),
                others=(),
                dropped=(),
                ranking=ranking,
                loss_ratios=loss_ratios(added, best.fit.test_loss, instead),
                folds=(int(np.sum(result.fold_losses < before.fold_losses)), len(result.fold_losses)),
                by_holdout=data.tests_on_holdout,
            )
        )
        before = result
    return tuple(steps)


def _keys(found: Fit) -> set[EffectKey]:
    return {a.key for a in found.hypothesis.free}
