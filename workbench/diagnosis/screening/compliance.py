"""Compliance candidates (springs, backlash, soft base) from the inverse-dynamics residual."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import Compliance, Motion, Springs, crank_of, effect_named, giving_way, kinds, places
from workbench.models import AppliedEffect, Crank, Model, Placement
from workbench.simulation import on_all_cores

from ..policy import POLICY
from .candidate import Candidate
from .sensitivity import Linearisation


def compliance_candidates(
    linearisation: Linearisation, test_loss: float, found_before: Sequence[AppliedEffect] = ()
) -> list[Candidate]:
    """Return compliances that explain part of the residual torque, best first.

    Args:
        linearisation: of the model so far; those of its recordings that are fitted are used.
        test_loss: of the model so far; a candidate's own is its share of it.
        found_before: effects of the model whose parameters may change. A spring among them was fitted to the
            total compliance, so that another one is fitted together with it.
    """
    springs = tuple(a for a in found_before if kinds.is_spring(effect_named(a.key.effect)))
    asked = tuple(a.key for a in springs)
    if asked not in linearisation.compliances:
        linearisation.compliances[asked] = _shares(linearisation, springs)
    return [replace(c, test_loss=c.test_loss * test_loss) for c in linearisation.compliances[asked]]


def _shares(linearisation: Linearisation, springs: Sequence[AppliedEffect]) -> list[Candidate]:
    """Return candidates whose `test_loss` is the share of the residual torque that they leave."""
    motions = [_without_own_compliance(m, linearisation.model) for m in linearisation.fitted_motions]

    def asked(key: EffectKey) -> list[Candidate]:
        if (
            kinds.is_spring(effect_named(key.effect))
            and springs
            and all(a.key.axis != key.axis for a in springs)
        ):
            return _beside(springs, key, linearisation)
        effect, place = effect_named(key.effect), Placement.of(linearisation.model, key)
        initial_values = effect.initial_values(motions, linearisation.model, place)
        some = [(shape, left) for shape, left in initial_values if left < POLICY.compliance_left]
        return [Candidate(key, np.zeros(0), shape, left) for shape, left in some]

    asked_of = [
        key
        for key in places(linearisation.model)
        if isinstance(effect_named(key.effect), Compliance)
        and linearisation.data.replay.shows(key.effect)
        and equivalent_at_drive(linearisation.model, key) is None
    ]
    found = [candidate for some in on_all_cores(asked, asked_of) for candidate in some]
    found.sort(key=lambda c: c.test_loss)
    # backlash is fitted to the torque more flexibly, so that it leaves less than a true spring
    return [
        c
        for c in found
        if c.test_loss <= POLICY.compliance_times * found[0].test_loss
        or (c.test_loss <= POLICY.compliance_beside_gap and not kinds.diverges(effect_named(c.key.effect)))
    ][: POLICY.compliance_candidates]


def _beside(
    springs: Sequence[AppliedEffect], key: EffectKey, linearisation: Linearisation
) -> list[Candidate]:
    """The candidate with one more spring and the stiffness of all springs fitted together; otherwise none."""
    keys = {a.key for a in springs}
    rigid = replace(
        linearisation.model, effects=tuple(e for e in linearisation.model.effects if e.key not in keys)
    )
    motions = [_without_own_compliance(m, rigid) for m in linearisation.fitted_motions]
    seats = (Placement.of(rigid, k) for k in (*(a.key for a in springs), key))
    known, now = [seat for seat in seats if seat is not None], [a.values for a in springs]
    alone, together = Springs(motions, rigid, known[:-1]), Springs(motions, rigid, known)
    if not together.apart:
        return []
    *others, own = together.guess(now)
    left = together.share([*others, own]) / max(alone.share(now), 1e-12)
    if left > POLICY.compliance_more:
        return []
    beside = {a.key: shape for a, shape in zip(springs, others, strict=True)}
    return [Candidate(key, np.zeros(0), own, left, beside)]


def _without_own_compliance(motion: Motion, model: Model) -> Motion:
    """Return the motion without the torque of the model's own compliances: inverse dynamics are rigid."""
    for effect, place, shape in giving_way(model):
        offset = effect.response(motion, model, place, shape).offset
        motion = replace(motion, required=_less(motion, offset / motion.gain))
    return motion


def _less(motion: Motion, torque: np.ndarray) -> Callable[[Model], np.ndarray]:
    return lambda model: motion.required(model) - torque


def equivalent_at_drive(model: Model, key: EffectKey) -> EffectKey | None:
    """Return the place at the drive that is equivalent to a place at the joint, if a single drive turns it;
    otherwise None.

    With a linkage in the model they differ: its crank and coupler are on the link side of a spring at the
    drive, and on the motor side of one at the joint.
    """
    if key.axis is None or key.location != "joint" or not isinstance(effect_named(key.effect), Compliance):
        return None
    index = model.axes.index(key.axis)
    turned = np.flatnonzero(model.transmission[:, index])
    drive = EffectKey(key.effect, key.axis)
    alone = turned.tolist() == [index] and crank_of(model) == Crank()
    return drive if alone and effect_named(key.effect).applies(model, drive) else None


def equivalents_at_joint(model: Model, key: EffectKey) -> tuple[EffectKey, ...]:
    """Return places at the joint that are equivalent to this one at a drive."""
    pin = EffectKey(key.effect, key.axis, "joint")
    return (pin,) if key.location == "actuator" and equivalent_at_drive(model, pin) == key else ()


def other_causes(model: Model, key: EffectKey, keys: Iterable[EffectKey]) -> tuple[EffectKey, ...]:
    """Return those of `keys` that are another cause, not an equivalent of `key` at the joint."""
    same = equivalents_at_joint(model, key)
    return tuple(other for other in keys if other not in same)
