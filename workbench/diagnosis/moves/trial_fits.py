"""Which screened effects are simulated for the next step, in which order, and how well they fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named

from ..acceptance import helps, reached
from ..data import Data
from ..fitting.fit import fit, race
from ..fitting.refinement import settle, with_candidate
from ..hypothesis import Fit
from ..loss import floor_of_judging
from ..policy import POLICY
from ..screening.command_path import astray
from ..screening.compliance import what_gives_way
from ..screening.screen import Candidate
from ..screening.sensitivity import Scene
from .choice import Explanation

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Standpoint:
    """Where a search stands that looks for its next effect.

    Attributes:
        scene: the loops linearised there.
        candidates: screened effects that the model does not have, best first.
        current: the fit so far.
        data: recordings and weights.
        later: whether this is not the first effect.
        progress: told what is being done.
    """

    scene: Scene
    candidates: tuple[Candidate, ...]
    current: Fit
    data: Data
    later: bool
    progress: Progress

    @cached_property
    def floor(self) -> float:
        """Judged error that a perfect model would have."""
        return floor_of_judging(self.data)

    @cached_property
    def excess(self) -> float:
        """Judged error above that floor."""
        return max(self.current.judged - self.floor, 1e-12)

    @cached_property
    def stated(self) -> tuple[Candidate, ...]:
        """What the model file itself states, so that nothing of it has to be fitted."""
        return tuple(
            c
            for c in self.candidates
            if effect_named(c.key.effect).free(self.scene.model) == 0 and not c.shape
        )

    def stated_helps(self, fits: Sequence[Explanation]) -> bool:
        """Whether something helps that the model file states."""
        return any(c in self.stated for c, f in fits if helps(f, self.current, self.excess))


@dataclass(frozen=True)
class Tried:
    """What simulations said.

    Attributes:
        fits: candidates with their fits, tier after tier, each best first.
        at_first: share of the excess that candidates removed on the few recordings on which they are fitted
            first; all that is known of those that are given up there.
    """

    fits: tuple[Explanation, ...] = ()
    at_first: tuple[tuple[EffectKey, float], ...] = ()

    def __add__(self, more: Tried) -> Tried:
        return Tried((*self.fits, *more.fits), (*self.at_first, *more.at_first))


def try_in_order(at: Standpoint) -> Tried:
    """Simulate what the file states, then basic effects, refinements, and springs and gaps, as far as needed.

    Whatever has reached the noise ends it. What is stated makes refinements and springs needless if it helps.
    """
    simple, refined = _free_tiers(at)
    tried = Tried()
    for tier in (at.stated, simple, refined):
        if any(reached(f, at.data) for _, f in tried.fits):
            break
        if tier and not (tier is refined and at.stated_helps(tried.fits)):
            tried += _settled(_fitted(tier, at), at)
    enough = POLICY.compliance_from_later if at.later else POLICY.compliance_from
    if at.stated_helps(tried.fits) or any(reached(f, at.data, enough) for _, f in tried.fits):
        return tried
    return tried + _springs_and_gaps(tried.fits, at)


def _free_tiers(at: Standpoint) -> tuple[list[Candidate], list[Candidate]]:
    """Basic effects and refinements whose first estimate promises enough, no more than are simulated."""
    gain = POLICY.later_gain if at.later else POLICY.effect_gain
    needed = POLICY.screened_gain * gain * at.excess
    free = [c for c in at.candidates if c not in at.stated and c.judged < at.current.judged - needed]
    # a first estimate leaves what the linearisation misses; only clear losers go unsimulated
    best_left = max(min((c.judged for c in free), default=0.0) - at.floor, 0.0)
    most = POLICY.screened_times * best_left + POLICY.screened_slack * at.excess
    free = [c for c in free if c.judged - at.floor <= most]
    simple, refined = ([c for c in free if effect_named(c.key.effect).tier == tier] for tier in (0, 1))
    return simple[: POLICY.simple_simulated], refined[: POLICY.refined_simulated]


def _springs_and_gaps(rigid: Sequence[Explanation], at: Standpoint) -> Tried:
    """What lets motors and links move apart; dear to simulate, and seldom asked for where all is rigid."""
    at.progress("looking for springs and gaps")
    best = min((f.judged for _, f in rigid), default=np.inf)
    late = what_gives_way(at.scene, at.data.training, at.current.judged, at.current.hypothesis.free)
    late = [c for c in late if c.judged < POLICY.compliance_simulated * best]
    return _fitted(late, at) if late else Tried()


def _fitted(chosen: Sequence[Candidate], at: Standpoint) -> Tried:
    """Candidates with their fits; what does not run is left out."""
    at.progress(f"fitting {', '.join(str(c.key) for c in chosen)}")
    pairs: list[Explanation] = []
    at_first: list[tuple[EffectKey, float]] = []
    for wanders in (False, True):
        part = [c for c in chosen if effect_named(c.key.effect).wanders is wanders]
        if not part:
            continue
        tried = [with_candidate(at.scene, c, at.current) for c in part]
        if wanders:
            results, shares = fit(tried, at.data, 1), [None] * len(part)
        else:
            results, shares = race(tried, at.current, at.data)
        pairs += [(c, _as_read(c, f, at)) for c, f in zip(part, results, strict=True) if f is not None]
        at_first += [(c.key, x) for c, x in zip(part, shares, strict=True) if x is not None]
    return Tried(tuple(sorted(pairs, key=lambda cf: cf[1].trained)), tuple(at_first))


def _as_read(candidate: Candidate, found: Fit, at: Standpoint) -> Fit:
    """A fit, or the values that the drive's channel shows, where fitting has led away from them."""
    if not astray(at.scene, candidate, found):
        return found
    return fit([with_candidate(at.scene, candidate, at.current)], at.data, 1)[0] or found


def _settled(tier: Tried, at: Standpoint) -> Tried:
    """A tier's fits, those that may be chosen with the way in which their friction sets in."""
    if not tier.fits:
        return tier
    close = POLICY.onset_close * tier.fits[0][1].trained
    best = [
        (c, settle(f, at.data, at.floor) if f.trained < close else f)
        for c, f in tier.fits[: POLICY.onset_simulated]
    ]
    return Tried((*best, *tier.fits[POLICY.onset_simulated :]), tier.at_first)
