"""Trial fits: which screened effects are fitted for the next step, in which order, and how well they fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds
from workbench.report.wording import any_of, effect_phrases

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

_NAMED = 3  # effects that a line of progress names


@dataclass(frozen=True)
class SearchState:
    """The state of a search that is looking for its next effect.

    Attributes:
        linearisation: of the loops about the current fit.
        candidates: screened effects that the model does not have, best first.
        current: the fit so far.
        data: recordings and weights.
        later: whether this is not the first effect.
        progress: told what is being done.
        at_first: share of the excess that candidates removed on the few recordings on which they are fitted
            first; all that is known of those that are given up there.
    """

    linearisation: Linearisation
    candidates: tuple[Candidate, ...]
    current: Fit
    data: Data
    later: bool
    progress: Progress
    at_first: dict[EffectKey, float] = field(default_factory=dict)

    @cached_property
    def floor(self) -> float:
        """Return the test loss of a perfect model."""
        return test_noise_floor(self.data)

    @cached_property
    def excess(self) -> float:
        """Return the excess: test loss above that floor."""
        return max(self.current.test_loss - self.floor, 1e-12)

    @cached_property
    def parameter_free(self) -> tuple[Candidate, ...]:
        """Return candidates without free parameters, whose values the model file states."""
        return tuple(
            c
            for c in self.candidates
            if kinds.free_parameters(effect_named(c.key.effect), self.linearisation.model) == 0
            and not c.shape
        )

    def parameter_free_helps(self, fits: Sequence[Explanation]) -> bool:
        """Return whether a parameter-free candidate improves the fit."""
        return any(c in self.parameter_free for c, f in fits if improves(f, self.current, self.excess))


def try_in_order(at: SearchState) -> list[Explanation]:
    """Return fits of parameter-free candidates, then basic effects, refinements and compliances, as far as
    needed.

    Tier after tier, each best first. A fit at the noise floor ends it. A parameter-free candidate that helps
    makes refinements and compliances needless.
    """
    simple, refined = _free_tiers(at)
    tried: list[Explanation] = []
    for tier in (at.parameter_free, simple, refined):
        if any(at_noise_floor(f, at.data) for _, f in tried):
            break
        if tier and not (tier is refined and at.parameter_free_helps(tried)):
            tried += _with_sliding_speed(_fitted(tier, at), at)
    enough = POLICY.compliance_from_later if at.later else POLICY.compliance_from
    if at.parameter_free_helps(tried) or any(at_noise_floor(f, at.data, enough) for _, f in tried):
        return tried
    return tried + _springs_and_gaps(tried, at)


def _free_tiers(at: SearchState) -> tuple[list[Candidate], list[Candidate]]:
    """Basic effects and refinements with a promising first estimate, at most as many as may be simulated.

    What a refinement contains is simulated with it: a first estimate hardly tells a friction from one that
    gives way before it slides.
    """
    gain = POLICY.later_gain if at.later else POLICY.effect_gain
    needed = POLICY.screened_gain * gain * at.excess
    free = [
        c for c in at.candidates if c not in at.parameter_free and c.test_loss < at.current.test_loss - needed
    ]
    # a first estimate leaves what the linearisation misses; only clear losers go unsimulated
    best_left = max(min((c.test_loss for c in free), default=0.0) - at.floor, 0.0)
    most = POLICY.screened_times * best_left + POLICY.screened_slack * at.excess
    free = [c for c in free if c.test_loss - at.floor <= most]
    simple, refined = ([c for c in free if _tier(c) == tier] for tier in (0, 1))
    simple, refined = simple[: POLICY.simple_simulated], refined[: POLICY.refined_simulated]
    contained = [c for c in at.candidates if any(contains(r.key, c.key) for r in refined)]
    return simple + [c for c in contained if _tier(c) == 0 and c not in simple], refined


def _tier(candidate: Candidate) -> int:
    return kinds.tier_of(effect_named(candidate.key.effect))


def _springs_and_gaps(rigid: Sequence[Explanation], at: SearchState) -> list[Explanation]:
    """Return fits of springs and backlash, which are expensive to simulate and seldom needed."""
    at.progress("looking for springs and gaps")
    best = min((f.test_loss for _, f in rigid), default=np.inf)
    late = compliance_candidates(at.linearisation, at.current.test_loss, at.current.hypothesis.free)
    late = [c for c in late if c.test_loss < POLICY.compliance_simulated * best]
    return _fitted(late, at) if late else []


def _fitted(chosen: Sequence[Candidate], at: SearchState) -> list[Explanation]:
    """Return candidates with their fits, each in its best form, without those whose simulation fails."""
    named = effect_phrases([c.key for c in chosen])
    if len(named) > _NAMED:  # a line of a terminal holds no more
        named = [*named[: _NAMED - 1], f"{len(named) - _NAMED + 1} other effects"]
    at.progress(f"fitting {any_of(named)}")
    pairs: list[Explanation] = []
    in_all_forms = [form for c in chosen for form in (c, *c.others)]
    for diverges in (False, True):
        part = [c for c in in_all_forms if kinds.diverges(effect_named(c.key.effect)) is diverges]
        if not part:
            continue
        tried = [with_candidate(at.linearisation, c, at.current) for c in part]
        if diverges:
            results = fit(tried, at.data, 1)
        else:
            results, shares = successive_halving(tried, at.current, at.data)
            for c, x in zip(part, shares, strict=True):
                if x is not None:
                    at.at_first[c.key] = max(x, at.at_first.get(c.key, x))
        pairs += [(c, _as_read(c, f, at)) for c, f in zip(part, results, strict=True) if f is not None]
    return sorted(_in_best_form(pairs, at.floor), key=lambda cf: cf[1].training_loss)


def _in_best_form(fits: Sequence[Explanation], floor: float) -> list[Explanation]:
    """Return one fit per effect: of the form that leaves least, or of a simpler one that ties with it.

    An extended form has to leave less than half of the excess above the floor.
    """
    known: dict[EffectKey, list[Explanation]] = {}
    for candidate, found in fits:
        known.setdefault(candidate.key, []).append((candidate, found))
    best = []
    for key, own in known.items():
        parameters = effect_named(key.effect).parameters
        usual = [(c, f) for c, f in own if not parameters.is_extended(c.shape)]
        left = min((f.test_loss for _, f in usual), default=np.inf)
        enough = min(left / (1.0 + POLICY.tie), floor + POLICY.exchange_left * (left - floor))
        own = [(c, f) for c, f in own if parameters.is_extended(c.shape) and f.test_loss < enough] or usual
        most = (1.0 + POLICY.tie) * min(f.test_loss for _, f in own)
        ties = [(c, f) for c, f in own if f.test_loss <= most]
        best.append(min(ties, key=lambda cf: (len(cf[0].coefficients), cf[1].test_loss)))
    return best


def _as_read(candidate: Candidate, found: Fit, at: SearchState) -> Fit:
    """Return the fit, or the values from the command path if fitting moved far away from them."""
    if not off_command_path(at.linearisation, candidate, found):
        return found
    return fit([with_candidate(at.linearisation, candidate, at.current)], at.data, 1)[0] or found


def _with_sliding_speed(tier: list[Explanation], at: SearchState) -> list[Explanation]:
    """Return the fits of a tier; those that may be chosen have their sliding speed tuned."""
    close = POLICY.onset_close * min((f.training_loss for _, f in tier), default=np.inf)
    best = [
        (c, tune_sliding_speed(f, at.data, at.floor) if f.training_loss < close else f)
        for c, f in tier[: POLICY.onset_simulated]
    ]
    return best + tier[POLICY.onset_simulated :]
