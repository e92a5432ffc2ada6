"""One cause on every axis: joints that were built alike lack the same things."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import EFFECTS

from ..acceptance import explains_most, helps_an_axis, nearly_at_floor, overshadowed, spoils
from ..data import Data
from ..fitting.fit import fit, race
from ..fitting.refinement import polished, settle, with_candidates
from ..hypothesis import Fit
from ..loss import floor_of_judging, rejudged
from ..policy import POLICY
from ..removed_share import removed_share, removed_shares
from ..screening.screen import Candidate, Entry, equations, judge, limits_of
from ..screening.sensitivity import Column, Scene
from ..search_result import Stage
from ..significance import cancels, witnessed
from .choice import behind, simplest_first

# What a plain model of drives leaves out together: sets that are tried beside each effect by itself.
_FRICTION = ("coulomb_friction", "viscous_damping")
_DRIVES = (*_FRICTION, "reflected_inertia")


@dataclass(frozen=True)
class _Fitted:
    """Effects, each on all axes, with their fit."""

    effects: tuple[str, ...]
    fit: Fit


def on_every_axis(
    screened: Sequence[Candidate], scene: Scene, data: Data, start: Fit, progress: Callable[[str], None]
) -> tuple[Stage, ...]:
    """The effects, one or a few that go together, which explain most when all axes have them.

    Where each of many axes has a share of what is lacking, none explains enough by itself. Axes that do
    well without are left out again.

    Args:
        screened: every effect in every place, as a first one.
        scene: the model that lacks something.
        data: its recordings.
        start: the model as it is.
        progress: told what is being done.

    Returns:
        One stage an effect and axis, what does most first; their data and runs are not their own yet.
        Empty where nothing explains much.
    """
    if scene.model.size < 2:
        return ()
    progress("looking for one cause on every axis")
    if overshadowed(start, data):  # held-out motion that shows little cannot judge
        data = data.unheard()
        start = rejudged(start, data)
    sets = _promising(screened, scene, data, start)[: POLICY.sets_simulated]
    if not sets:
        return ()
    progress(f"fitting {'; '.join(' and '.join(names) for names, _ in sets)} on every axis")
    tried = [with_candidates(scene, chosen, start) for _, chosen in sets]
    raced = zip(sets, race(tried, start, data)[0], strict=True)
    fits = [_Fitted(names, f) for (names, _), f in raced if f is not None]
    floor = floor_of_judging(data)
    for found in simplest_first(fits, data, POLICY.later_gain):
        best = replace(found, fit=polished(needed(settle(found.fit, data, floor), data), data))
        if len(best.fit.hypothesis.free) < 2 or not explains_most(best.fit, start, data):
            continue
        sound = witnessed(scene, best.fit) and not cancels(scene, best.fit)
        if sound and not spoils(best.fit, start, data):
            return _stages(best, fits, data, start)
    return ()


def needed(whole: Fit, data: Data, doubted: Collection[EffectKey] | None = None) -> Fit:
    """The fit with only those effects without any of which more would be left than the whole fit leaves.

    `doubted`: of which it is asked; all where it is left out.
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
            and (nearly_at_floor(f, data) or not helps_an_axis(whole, f, data))
        ]
        if not idle:
            break
        found = min(idle, key=lambda f: f.judged)
    return found


def _promising(
    screened: Sequence[Candidate], scene: Scene, data: Data, start: Fit
) -> list[tuple[tuple[str, ...], list[Candidate]]]:
    """Sets of effects by what they leave on the linearised loop, with each axis's share of it."""
    at_drives = {
        (c.key.effect, c.key.axis): c
        for c in screened
        if c.key.axis is not None and c.key.location == "actuator" and np.isfinite(c.judged)
    }
    there = {effect for effect, _ in at_drives}
    names = [effect.name for effect in EFFECTS if effect.of_a_make and effect.name in there]
    columns, entries = _columns(scene, [c for c in at_drives.values() if c.key.effect in names])
    if not columns:
        return []
    pieces, held_out = equations(scene, [], columns, data, start.simulated)
    floor, excess = floor_of_judging(data), _excess(start, data)
    options = (*((name,) for name in names), _FRICTION, _DRIVES)
    everywhere = set(scene.model.driven)
    tries = [(option, everywhere) for option in options]
    for option in options:
        gains = {a: start.judged - _least(at_drives, option, a) for a in everywhere}
        shown = {a for a in everywhere if gains[a] > POLICY.axis_share * excess[a]}
        if POLICY.axes_alike <= len(shown) < len(everywhere):
            tries.append((option, shown))
    found: list[tuple[float, tuple[str, ...], list[Candidate]]] = []
    for option, axes in tries:
        own = [e for name in option for e in entries if e.key.effect == name and e.key.axis in axes]
        if len(own) < 2:
            continue
        gone = (1.0 - POLICY.promising) * sum(excess[a] for a in axes)
        most = floor + max(start.judged - floor, 0.0) - gone
        bounds = [np.concatenate(b) for b in zip(*(limits_of(scene, e) for e in own), strict=True)]
        index = [k for e in own for k in e.linear]
        fixed = [e.fixed for e in own if e.fixed is not None]
        judged, solution = judge(pieces, held_out, index, fixed, (bounds[0], bounds[1]))
        parts = np.split(solution, np.cumsum([len(e.linear) for e in own])[:-1])
        chosen = [Candidate(e.key, x, e.shape, judged) for e, x in zip(own, parts, strict=True)]
        if judged < most:
            found.append((judged, option, chosen))
    return [(option, chosen) for _, option, chosen in sorted(found, key=lambda f: f[0])]


def _excess(start: Fit, data: Data) -> dict[str, float]:
    """Judged error above the noise, by axis."""
    part = data.held_out_judges
    above = np.maximum(data.pool(start.mean_squares, part) - data.least(part), 0.0)
    return dict(zip(data.recordings[0].axes, np.sum(above * data.weight**2, axis=0).tolist(), strict=True))


def _least(candidates: Mapping[tuple[str, str], Candidate], names: Sequence[str], axis: str) -> float:
    """Judged error that the best of these effects would leave by itself on one axis."""
    return min((candidates[n, axis].judged for n in names if (n, axis) in candidates), default=np.inf)


def _columns(scene: Scene, candidates: Sequence[Candidate]) -> tuple[list[Column], list[Entry]]:
    """Columns of candidates in their best shape, and where they stand."""
    columns: list[Column] = []
    entries: list[Entry] = []
    for c in candidates:
        linear, fixed = scene.columns(c.key, c.shape)
        first = len(columns)
        columns += [*linear, *([fixed] if fixed else [])]
        last = first + len(linear)
        entries.append(Entry(c.key, c.shape, list(range(first, last)), last if fixed else None, 1.0))
    return columns, entries


def _stages(best: _Fitted, fits: Sequence[_Fitted], data: Data, start: Fit) -> tuple[Stage, ...]:
    """The effects one after the other, what does most by itself first."""
    whole = best.fit.hypothesis
    singles = fit([replace(whole, free=(a,)) for a in whole.free], data, iterations=2)
    left = [np.inf if s is None else s.judged for s in singles]
    order = [whole.free[k] for k in np.argsort(left, kind="stable")]
    parts = [replace(whole, free=tuple(order[: k + 1])) for k in range(len(order) - 1)]
    grown = [f for f in fit(parts, data) if f is not None]
    floor = floor_of_judging(data)
    alone = [(a.key, judged) for a, judged in zip(whole.free, left, strict=True) if judged < np.inf]
    ranking = removed_shares(start.judged, alone, floor)
    forms = set(best.effects) | {e.name for e in EFFECTS if set(e.contains) & set(best.effects)}
    instead = [(f.fit.hypothesis.free[0].key, f.fit.judged) for f in fits if not set(f.effects) & forms]
    before, stages = start, []
    for result in (*grown, best.fit):
        added = next(a.key for a in order if a.key not in _keys(before) and a.key in _keys(result))
        stages.append(
            Stage(
                added=added,
                fit=result,
                data=data,
                removed_share=removed_share(before.judged, result.judged, floor),
                rivals=(),
                others=(),
                dropped=(),
                ranking=ranking,
                behind=behind(added, best.fit.judged, instead),
                folds=(int(np.sum(result.agreeing < before.agreeing)), len(result.agreeing)),
                by_held_out=data.held_out_judges,
            )
        )
        before = result
    return tuple(stages)


def _keys(found: Fit) -> set[EffectKey]:
    return {a.key for a in found.hypothesis.free}
