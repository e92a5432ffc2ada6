"""One step of the search: which effect to add now."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains

from ..acceptance import explains_fitted, helps, lowers_error
from ..data import Data
from ..fitting.refinement import polished, prune
from ..hypothesis import Fit
from ..naming import named_beside, special_case, twins_of
from ..removed_share import removed_share
from ..screening.command_path import astray
from ..screening.screen import Candidate
from ..screening.sensitivity import Scene
from ..search_result import Stage
from ..significance import cancels, witnessed
from .choice import Explanation, behind, choose
from .trial_fits import Progress, Standpoint, Tried, try_in_order


@dataclass(frozen=True)
class _Choice:
    """The effect that is taken.

    Attributes:
        candidate: what was screened.
        found: its fit, as it was simulated beside the others.
        kept: the same polished, without what it made needless.
        rivals: effects that do as well, those that no data can tell from it included.
        needless: effects that were found before, which it contains or replaces.
        explanations: all candidates that may be named, with their fits.
    """

    candidate: Candidate
    found: Fit
    kept: Fit
    rivals: tuple[EffectKey, ...]
    needless: tuple[EffectKey, ...]
    explanations: tuple[Explanation, ...]

    @property
    def key(self) -> EffectKey:
        """The effect."""
        return self.candidate.key


def next_stage(
    scene: Scene,
    candidates: Sequence[Candidate],
    current: Fit,
    data: Data,
    progress: Progress,
    *,
    later: bool = False,
    bold: bool = False,
    basics_first: bool = True,
) -> Stage | None:
    """The effect to add now, or None where nothing helps.

    What the model file itself states (its drives' inertia behind the transmission, a linkage that was
    identified) has no free parameter and cannot overfit: it comes first. Then basic effects, then
    refinements, unless simpler ones have reached the noise.

    Boldly, an effect is taken that explains most of what was fitted, whatever the folds say: causes that are
    still missing may set them against it. Only what such a step leads to can justify it.
    """
    fitted = {a.key for a in current.hypothesis.free}
    new = tuple(c for c in candidates if c.key not in fitted)
    at = Standpoint(scene, new, current, data, later, progress)
    tried = try_in_order(at)
    helpful = _helpful(tried, at, explains_fitted if bold else helps)
    if not helpful:
        return None
    choice = _choice(helpful, at, basics_first)
    return None if cancels(scene, choice.kept) else _stage(choice, tried, at)


def _helpful(tried: Tried, at: Standpoint, enough: Callable[[Fit, Fit, float], bool]) -> list[Explanation]:
    """What may be named: it explains enough, lowers the error, and the motions show it."""
    better = [
        (c, f)
        for c, f in tried.fits
        if enough(f, at.current, at.excess) and lowers_error(f, at.current, at.data)
    ]
    return [(c, f) for c, f in better if witnessed(at.scene, f)]


def _choice(helpful: list[Explanation], at: Standpoint, basics_first: bool) -> _Choice:
    """The best of what helps, with what does as well and without what it makes needless."""
    candidate, found, rivals = choose(
        helpful, at.stated, at.current.judged, at.data, at.scene.model, basics_first
    )
    candidate, found = special_case(at.scene, candidate, found, helpful, at.data)
    wider = named_beside(at.scene, at.candidates, candidate, found, at.current, at.data)
    rivals = (*rivals, *(c.key for c, _ in wider))
    kept, needless = prune(found, candidate.key, at.data, at.current)
    fine = polished(kept, at.data)
    kept = kept if astray(at.scene, candidate, fine) else fine
    same = twins_of(at.scene.model, candidate.key, at.data.recordings)
    rivals = (*rivals, *(k for k in same if k not in rivals))
    return _Choice(candidate, found, kept, rivals, needless, (*helpful, *wider))


def _stage(choice: _Choice, tried: Tried, at: Standpoint) -> Stage:
    """The record of the step."""
    before, kept, data = at.current, choice.kept, at.data
    left = {a.key for a in kept.hypothesis.added}
    return Stage(
        added=choice.key,
        fit=kept,
        data=data,
        removed_share=removed_share(before.judged, kept.judged, at.floor),
        rivals=(*choice.rivals, *(k for k in choice.needless if not contains(choice.key, k))),
        others=tuple(
            (c.key, f.hypothesis.model)
            for c, f in sorted(choice.explanations, key=lambda cf: cf[1].judged)
            if _stands_for_itself(c, choice)
        ),
        dropped=tuple(a.key for a in before.hypothesis.added if a.key not in left),
        ranking=_ranking(tried, at),
        behind=behind(choice.key, choice.found.judged, ((c.key, f.judged) for c, f in tried.fits)),
        folds=(int(np.sum(kept.agreeing < before.agreeing)), len(kept.agreeing)),
        by_held_out=data.held_out_judges,
    )


def _stands_for_itself(other: Candidate, choice: _Choice) -> bool:
    """Whether it is another explanation than the chosen one, not a part of it nor the same with more."""
    return (
        other is not choice.candidate
        and (other.key in choice.rivals or not contains(other.key, choice.key))
        and not contains(choice.key, other.key)
    )


def _ranking(tried: Tried, at: Standpoint) -> tuple[tuple[EffectKey, float], ...]:
    """What every simulated candidate removed of the excess, best first."""
    removed = dict(tried.at_first)
    removed |= {c.key: removed_share(at.current.judged, f.judged, at.floor) for c, f in tried.fits}
    return tuple(sorted(removed.items(), key=lambda r: -r[1]))
