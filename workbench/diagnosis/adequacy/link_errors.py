"""Errors of the masses of all links together, where the model's are only guesses.

A plain arm needs a torque that is linear in masses, centres and inertias of its links, in combinations that
its motion shows (base parameters: M. Gautier and W. Khalil, IEEE Trans. Robotics and Automation 6(3), 1990).
Where many of these are wrong no single one explains much, and together they hide friction, which they cannot
imitate: they know no direction. Fitted beside all laws at once, without the bounds that masses have, they are
one more free function, of all positions, speeds and accelerations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import effect_named, kinds, link_regressor
from workbench.models import AppliedEffect
from workbench.simulation import scored_torque

from ..data import Data
from ..fitting.left_out import left_out
from ..fitting.normal_equations import Normal, jackknife, total
from ..policy import POLICY
from ..screening.equations import Entry
from ..screening.needed_torque import needing
from ..screening.sensitivity import Linearisation, SensitivityColumn
from ..screening.torque_columns import torque_rows
from ..screening.torque_regression import Regression
from .laws import is_of_drives

_RIDGE = 1e-9  # on columns of size one: holds what no motion shows
_TOLERANCE = 1e-6  # of a column's square: less of it beside others is rounding
_PENALTIES = np.logspace(-8, 0, 9)  # of the links' part, times the mean of its normal equations' diagonal


@dataclass(frozen=True, eq=False)
class LinkErrors:
    """What errors of all links do.

    Attributes:
        sizes: of each of `columns_of_links`, (L,).
        share: of what laws leave, that they explain on folds left out.
    """

    sizes: np.ndarray
    share: float


def may_imitate_friction(key: EffectKey) -> bool:
    """Return whether errors of the links may do what an effect does; only friction knows a direction."""
    return "speed" not in kinds.depends_on(effect_named(key.effect))


def link_errors(regression: Regression, chosen: Sequence[Entry], data: Data) -> LinkErrors | None:
    """Return what all links together explain beside all basic laws of the drives and other effects.

    Args:
        regression: of all effects along the measured motion.
        chosen: the effects that were found.
        data: of that motion.

    Returns:
        None where they explain less than `POLICY.unknown_most` of what the others leave.
    """
    linearisation = regression.linearisation
    laws = [e for e in regression.entries if is_of_drives(e.key)]
    laws += [e for e in chosen if e.key.axis and e not in laws and not _is_of_links(e.key)]
    motions = needing(linearisation)
    first = [c for e in laws for c in linearisation.columns(e.key, e.shape, motions)[0]]
    rows = torque_rows(linearisation, [*first, *columns_of_links(linearisation)], data)
    blocks, scale = _scaled([total(fold) for fold in rows.folds(data)])
    own, eye = np.arange(len(scale)) < len(first), np.eye(len(scale))
    ridge = _RIDGE * eye
    beside = left_out(blocks, np.diag(np.where(own, 0.0, 1.0)), _PENALTIES, ridge)
    bare = list(range(len(first)))
    alone = left_out([b.pick(bare) for b in blocks], eye[own][:, own], np.zeros(1), ridge[own][:, own])
    noise = float(regression.floor.sum()) * sum(b.samples for b in blocks) / len(regression.floor)
    share = min((alone.left - beside.left) / max(alone.left - noise, 1e-300), 1.0)
    if share < POLICY.unknown_most:
        return None
    return LinkErrors((beside.whole / scale)[len(first) :], share)


def without_link_errors(
    errors: LinkErrors, regression: Regression, data: Data
) -> tuple[Recording, ...] | None:
    """Return recordings without the torque that errors of links do; None where no torque was recorded."""
    linearisation, names = regression.linearisation, [scored_torque(r) for r in data.recordings]
    if None in names:
        return None
    columns, out = columns_of_links(linearisation), []
    for i, (recording, name, motion) in enumerate(
        zip(data.recordings, names, linearisation.motions, strict=True)
    ):
        pushing = sum(size * column.torque[i] for size, column in zip(errors.sizes, columns, strict=True))
        # what pushes the machine is torque that its drives need not give
        given = (
            recording.signals[str(name)] + pushing / motion.gain @ linearisation.loops[i].reading.to_actuator
        )
        out.append(recording.with_signals(**{str(name): given}))
    return tuple(out)


def several_wrong(
    applied: Sequence[AppliedEffect], regression: Regression, chosen: Sequence[Entry], data: Data
) -> tuple[LinkErrors | None, set[EffectKey]]:
    """Return errors of all links if several of their numbers are wrong together, and what is not certain
    for it; None where an effect is gone beside them, but they do not explain most of what is left.

    Args:
        applied: effects with their values.
        regression: of all effects along the measured motion.
        chosen: the same effects in it, as far as they are torques.
        data: of that motion.
    """
    imitations = _imitations(applied, regression.linearisation, data)
    errors = link_errors(regression, chosen, data) if imitations else None
    return errors, imitations if errors else set()


def _imitations(applied: Sequence[AppliedEffect], linearisation: Linearisation, data: Data) -> set[EffectKey]:
    """Return the effects that are not certain if several numbers of links are wrong together.

    With all numbers of all links free beside them, what only came close to these is gone. If anything is,
    certain is what holds its size there: no error of one link, and nothing that is a sum of these numbers, as
    a rotor of the first axis is. Friction is no such sum.
    """
    laws = [a for a in applied if not _is_of_links(a.key)]
    asked = np.array([may_imitate_friction(a.key) for a in laws], bool)
    if not asked.any():
        return set()
    columns = [*(linearisation.total(a, a.values) for a in laws), *columns_of_links(linearisation)]
    blocks, scale = _scaled([total(fold) for fold in torque_rows(linearisation, columns, data).folds(data)])
    whole, count, ridge = total(blocks), len(laws), _RIDGE * np.eye(len(scale))
    own = 1.0 / np.diag(np.linalg.inv(whole.gram + ridge))[:count]  # of a column's square, no other has this
    rests = [whole - block for block in blocks]
    sizes = np.stack([np.linalg.solve(r.gram + ridge, r.right)[:count] for r in rests]) / scale[:count]
    size, deviation = sizes.mean(axis=0), POLICY.significant * jackknife(sizes)
    told, stays = own > _TOLERANCE, size > deviation
    if not (asked & told & ~stays & (size + deviation < 1.0)).any():
        return set()
    certain = {a.key for a, sure in zip(laws, ~asked | (told & stays), strict=True) if sure}
    return {a.key for a in applied} - certain


def _scaled(blocks: Sequence[Normal]) -> tuple[list[Normal], np.ndarray]:
    """Return normal equations of columns of one size, and the sizes that they had (C,); 1 of what is zero."""
    scale = np.sqrt(np.maximum(np.diag(total(blocks).gram), 0.0))
    scale = np.where(scale > 0.0, scale, 1.0)
    return [b.scaled(1.0 / scale) for b in blocks], scale


def columns_of_links(linearisation: Linearisation) -> list[SensitivityColumn]:
    """Return what each number of all links adds to the torque along the motion, per unit."""
    motions, axes = linearisation.motions, range(linearisation.model.size)
    each = [-np.concatenate([link_regressor(m, k) for k in axes]) for m in motions]
    none = tuple(None for _ in motions)
    return [SensitivityColumn(torque, none, none, none) for torque in zip(*each, strict=True)]


def _is_of_links(key: EffectKey) -> bool:
    return kinds.is_additive(effect_named(key.effect))
