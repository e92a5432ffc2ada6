"""Axes of an arm beside which larger troubles of others stood: each may have its own friction or rotor."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named

from .by_axis import explained_by_axis
from .choosing import behind
from .data import Data
from .fit import fit
from .hypothesis import Fit
from .judging import floor_of_judging, helps_an_axis, lowers_error, witnessed
from .refining import polished, with_candidate
from .removed import removed_share, removed_shares
from .screen import Candidate
from .stage import Stage
from .ways import Quest, Way, with_stages

_Tried = tuple[Candidate, Fit]


def on_further_axes(way: Way, quest: Quest) -> Way:
    """Where drives explain most of what several axes lack: the same asked of every other axis, by itself.

    Joints near the base carry the largest torques; beside an error of the masses there, what friction does
    is little of the whole, and yet most of what its axis lacks.

    Args:
        way: what was found so far; it comes back as it is unless it explains axis by axis.
        quest: what is searched for.
    """
    while not way.done and not quest.data.effort.spent and _axes(way.current, way, quest):
        taken = {a.key.axis for a in way.current.hypothesis.added}
        tried = _tried([c for c in quest.screened if c.key.axis not in taken], way, quest)
        good = [(c, f) for c, f in tried if _explains_its_axis(c, f, way, quest)]
        if not good:
            break
        candidate, found = min(good, key=lambda cf: cf[1].judged)
        quest.progress(f"found {candidate.key}, which its axis shows")
        way = with_stages(way, (_stage(candidate, found, tried, way),), quest.seed)
    return way


def _tried(new: list[Candidate], way: Way, quest: Quest) -> list[_Tried]:
    """Frictions and rotors beside what was found, with their fits."""
    basic = [c for c in new if effect_named(c.key.effect).basic and np.isfinite(c.judged)]
    fits = fit([with_candidate(quest.scene, c, way.current) for c in basic], way.data)
    return [(c, f) for c, f in zip(basic, fits, strict=True) if f is not None]


def _explains_its_axis(candidate: Candidate, found: Fit, way: Way, quest: Quest) -> bool:
    return (
        lowers_error(found, way.current, way.data)
        and helps_an_axis(found, way.current, way.data)
        and candidate.key.axis in _axes(found, way, quest)
        and witnessed(quest.scene, found)
    )


def _axes(found: Fit, way: Way, quest: Quest) -> dict[str, float]:
    return explained_by_axis(quest.data, quest.start, found, way.data)


def _stage(candidate: Candidate, found: Fit, tried: list[_Tried], way: Way) -> Stage:
    before, data, key = way.current, way.data, candidate.key
    kept = polished(found, data)
    own = [(c.key, f) for c, f in tried if c.key.axis == key.axis]
    floor = floor_of_judging(data)
    return Stage(
        added=key,
        fit=kept,
        data=data,
        removed_share=removed_share(before.judged, kept.judged, floor),
        rivals=(),
        others=tuple((k, f.hypothesis.model) for k, f in own if k != key),
        dropped=(),
        ranking=removed_shares(before.judged, [(k, f.judged) for k, f in own], floor),
        behind=behind(key, _left(found, key, data), ((k, _left(f, key, data)) for k, f in own)),
        folds=(int(np.sum(kept.agreeing < before.agreeing)), len(kept.agreeing)),
        by_held_out=data.held_out_judges,
    )


def _left(found: Fit, key: EffectKey, data: Data) -> float:
    """Judged squared error on an effect's own axis."""
    squares = data.pool(found.mean_squares, data.held_out_judges) * data.weight**2
    return float(np.sum(squares, axis=0)[data.recordings[0].axes.index(key.axis)])
