"""Naming: which effect, or which special case of it, a finding names, and which effects it lists beside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.core import EffectKey, Recording
from workbench.effects import EFFECTS, Effect, contains, effect_named, kinds, link_with, own_dry_friction
from workbench.models import AppliedEffect, Model, Placement
from workbench.simulation import scored_torque

from .data import Data
from .fitting.fit import successive_halving
from .fitting.refinement import with_candidate, with_candidates
from .hypothesis import Fit
from .loss import test_noise_floor
from .moves.choice import Explanation, worse_by
from .policy import POLICY
from .screening.candidate import Candidate
from .screening.compliance import equivalents_at_joint
from .screening.sensitivity import Linearisation


def named_beside(
    linearisation: Linearisation,
    candidates: Sequence[Candidate],
    chosen: Candidate,
    found: Fit,
    current: Fit,
    data: Data,
) -> list[Explanation]:
    """Return the effects that explain the data equally well and of which the chosen effect is a special case,
    without its own refinements.

    A special case always comes first; beside it they are named where motions do not settle which it is, as of
    a limit that was reached at one speed only. Only effects that can say so are fitted.
    """
    wider = [c for c in candidates if contains(c.key, chosen.key) and _can_be_distinguished(c)]
    if not wider:
        return []
    fits, _ = successive_halving([with_candidate(linearisation, c, current) for c in wider], current, data)
    return [
        (c, f)
        for c, f in zip(wider, fits, strict=True)
        if f is not None and worse_by(f, found) <= 1.0 + POLICY.tie and _differs(linearisation, f)
    ]


def on_each_drive(
    linearisation: Linearisation, candidates: Sequence[Candidate], chosen: Candidate, current: Fit, data: Data
) -> list[Explanation]:
    """Return the lags of single drives, on all drives at once, if one delay of the whole machine was chosen.

    Drives of one make are late alike, and slow motion hardly tells a lag from a delay.
    """
    whole, driven = chosen.key.axis is None, linearisation.model.driven
    if not (whole and len(driven) > 1 and kinds.is_pure_delay(effect_named(chosen.key.effect))):
        return []
    lags = [e.name for e in EFFECTS if e.locations and kinds.is_pure_delay(e)]
    sets = [[c for c in candidates if c.key.effect == lag] for lag in lags]
    sets = [own for own in sets if {c.key.axis for c in own} == set(driven)]
    asked = [with_candidates(linearisation, own, current) for own in sets]
    fits, _ = successive_halving(asked, current, data)
    return [(c, f) for own, f in zip(sets, fits, strict=True) if f is not None for c in own]


def special_case(
    linearisation: Linearisation, chosen: Candidate, found: Fit, helpful: Sequence[Explanation], data: Data
) -> Explanation:
    """Return the chosen effect, or its special case if the data need no more; a line that does not fall with
    speed is a plain limit.
    """
    if _can_be_distinguished(chosen) and not _differs(linearisation, found):
        enough = POLICY.chance_gain * max(found.test_loss, test_noise_floor(data))
        special = [(c, f) for c, f in helpful if contains(chosen.key, c.key) and f.test_loss < enough]
        return special[0] if special else (chosen, found)
    return chosen, found


def equivalents_of(model: Model, key: EffectKey, recordings: Sequence[Recording]) -> tuple[EffectKey, ...]:
    """Effects and places that no data can distinguish from this one (or no log without measured torque)."""
    effect = effect_named(key.effect)
    twins = effect.search.twins if key.location == "actuator" else ()
    if key.location == "actuator":
        twins = (*twins, *_rests_of(effect, model, key))
    if all(scored_torque(r) != "torque_measured" for r in recordings):
        twins = (*twins, *kinds.late_alike(effect, EFFECTS))
    return (*(replace(key, effect=name) for name in twins), *equivalents_at_joint(model, key))


def link_instead(model: Model, applied: AppliedEffect) -> tuple[EffectKey, ...]:
    """Return the link that carries a body with a centre of its own: other numbers of the link do the same."""
    effect = effect_named(applied.key.effect)
    _, form = effect.parameters.to_coefficients(applied.values)
    site = effect.site(model) if effect.parameters.is_extended(form) else None
    axis = None if site is None else link_with(model, site)
    return () if axis is None else (EffectKey("first_moment_error", axis),)


def _rests_of(effect: Effect, model: Model, key: EffectKey) -> tuple[str, ...]:
    """Return effects that this one completes: the model already has the dry friction that they contain."""
    place = Placement.of(model, key)
    whole = [e.name for e in EFFECTS if effect.name in e.search.twins]
    return tuple(whole) if whole and place and own_dry_friction(model, place) else ()


def _can_be_distinguished(candidate: Candidate) -> bool:
    return effect_named(candidate.key.effect).search.differs is not None


def _differs(linearisation: Linearisation, fit: Fit) -> bool:
    last = fit.hypothesis.free[-1]
    place = Placement.of(fit.hypothesis.model, last.key)
    differs = effect_named(last.key.effect).search.differs
    return differs is not None and differs(linearisation.motions, place, last.values)
