"""Which screened effects are fitted for the next step, in which order, and how well they fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named, kinds

from ..acceptance import at_noise_floor, improves
from ..data import Data
from ..fitting.fit import fit, successive_halving
from ..fitting.refinement import tune_sliding_speed, with_candidate
from ..hypothesis import Fit
from ..loss import test_noise_floor
from ..policy import POLICY
from ..problem import Progress
from ..screening.candidate import Candidate
from ..screening.command_path import off_command_path
from ..screening.compliance import compliance_candidates
from ..screening.sensitivity import Linearisation
from .choice import Explanation


@dataclass(frozen=True)
class SearchState:
    """The state of a search that looks for its next effect.

    Attributes:
        linearisation: of the loops about the current fit.
        candidates: screened effects that the model does not have, best first.
        current: the fit so far.
        data: recordings and weights.
        later: whether this is not the first effect.
        progress: told what is being done.
    """

    linearisation: Linearisation
    candidates: tuple[Candidate, ...]
    current: Fit
    data: Data
    later: bool
    progress: Progress

    @cached_property
    def floor(self) -> float:
        """Test loss of a perfect model."""
        return test_noise_floor(self.data)

    @cached_property
    def excess(self) -> float:
        """Test loss above that floor."""
        return max(self.current.test_loss - self.floor, 1e-12)

    @cached_property
    def parameter_free(self) -> tuple[Candidate, ...]:
        """Candidates without free parameters, which the model file states."""
        return tuple(
            c
            for c in self.candidates
            if kinds.free_parameters(effect_named(c.key.effect), self.linearisation.model) == 0
            and not c.shape
        )

    def parameter_free_helps(self, fits: Sequence[Explanation]) -> bool:
        """Whether a parameter-free candidate improves the fit."""
        return any(c in self.parameter_free for c, f in fits if improves(f, self.current, self.excess))


@dataclass(frozen=True)
class TrialFits:
    """Fits of candidates.

    Attributes:
        fits: candidates with their fits, tier after tier, each best first.
        at_first: share of the excess that candidates removed on the few recordings on which they are fitted
            first; all that is known of those that are given up there.
    """

    fits: tuple[Explanation, ...] = ()
    at_first: tuple[tuple[EffectKey, float], ...] = ()

    def __add__(self, more: TrialFits) -> TrialFits:
        return TrialFits((*self.fits, *more.fits), (*self.at_first, *more.at_first))


def try_in_order(at: SearchState) -> TrialFits:
    """Fits of parameter-free candidates, then basic effects, refinements, and compliances, as far as needed.

    A fit at the noise floor ends it. A parameter-free candidate that helps makes refinements and
    compliances needless.
    """
    simple, refined = _free_tiers(at)
    tried = TrialFits()
    for tier in (at.parameter_free, simple, refined):
        if any(at_noise_floor(f, at.data) for _, f in tried.fits):
            break
        if tier and not (tier is refined and at.parameter_free_helps(tried.fits)):
            tried += _with_sliding_speed(_fitted(tier, at), at)
    enough = POLICY.compliance_from_later if at.later else POLICY.compliance_from
    if at.parameter_free_helps(tried.fits) or any(at_noise_floor(f, at.data, enough) for _, f in tried.fits):
        return tried
    return tried + _springs_and_gaps(tried.fits, at)


def _free_tiers(at: SearchState) -> tuple[list[Candidate], list[Candidate]]:
    """Basic effects and refinements whose first estimate promises enough, no more than are simulated."""
    gain = POLICY.later_gain if at.later else POLICY.effect_gain
    needed = POLICY.screened_gain * gain * at.excess
    free = [
        c for c in at.candidates if c not in at.parameter_free and c.test_loss < at.current.test_loss - needed
    ]
    # a first estimate leaves what the linearisation misses; only clear losers go unsimulated
    best_left = max(min((c.test_loss for c in free), default=0.0) - at.floor, 0.0)
    most = POLICY.screened_times * best_left + POLICY.screened_slack * at.excess
    free = [c for c in free if c.test_loss - at.floor <= most]
    simple, refined = (
        [c for c in free if kinds.tier_of(effect_named(c.key.effect)) == tier] for tier in (0, 1)
    )
    return simple[: POLICY.simple_simulated], refined[: POLICY.refined_simulated]


def _springs_and_gaps(rigid: Sequence[Explanation], at: SearchState) -> TrialFits:
    """Fits of springs and backlash, which are expensive to simulate and seldom needed."""
    at.progress("looking for springs and gaps")
    best = min((f.test_loss for _, f in rigid), default=np.inf)
    late = compliance_candidates(at.linearisation, at.current.test_loss, at.current.hypothesis.free)
    late = [c for c in late if c.test_loss < POLICY.compliance_simulated * best]
    return _fitted(late, at) if late else TrialFits()


def _fitted(chosen: Sequence[Candidate], at: SearchState) -> TrialFits:
    """Candidates with their fits; what does not run is left out."""
    at.progress(f"fitting {', '.join(str(c.key) for c in chosen)}")
    pairs: list[Explanation] = []
    at_first: list[tuple[EffectKey, float]] = []
    for diverges in (False, True):
        part = [c for c in chosen if kinds.diverges(effect_named(c.key.effect)) is diverges]
        if not part:
            continue
        tried = [with_candidate(at.linearisation, c, at.current) for c in part]
        if diverges:
            results, shares = fit(tried, at.data, 1), [None] * len(part)
        else:
            results, shares = successive_halving(tried, at.current, at.data)
        pairs += [(c, _as_read(c, f, at)) for c, f in zip(part, results, strict=True) if f is not None]
        at_first += [(c.key, x) for c, x in zip(part, shares, strict=True) if x is not None]
    return TrialFits(tuple(sorted(pairs, key=lambda cf: cf[1].training_loss)), tuple(at_first))


def _as_read(candidate: Candidate, found: Fit, at: SearchState) -> Fit:
    """The fit, or the values from the command path, where fitting has moved far away from them."""
    if not off_command_path(at.linearisation, candidate, found):
        return found
    return fit([with_candidate(at.linearisation, candidate, at.current)], at.data, 1)[0] or found


def _with_sliding_speed(tier: TrialFits, at: SearchState) -> TrialFits:
    """Fits of a tier; those that may be chosen have their sliding speed tuned."""
    if not tier.fits:
        return tier
    close = POLICY.onset_close * tier.fits[0][1].training_loss
    best = [
        (c, tune_sliding_speed(f, at.data, at.floor) if f.training_loss < close else f)
        for c, f in tier.fits[: POLICY.onset_simulated]
    ]
    return TrialFits((*best, *tier.fits[POLICY.onset_simulated :]), tier.at_first)
