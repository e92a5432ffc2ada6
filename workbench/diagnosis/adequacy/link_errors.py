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
from workbench.effects import effect_named, kinds
from workbench.simulation import scored_torque

from ..data import Data
from ..fitting.left_out import left_out
from ..fitting.normal_equations import total
from ..policy import POLICY
from ..screening.equations import Entry
from ..screening.needed_torque import needing
from ..screening.sensitivity import SensitivityColumn
from ..screening.torque_regression import Chosen, Regression

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


def link_errors(regression: Regression, chosen: Sequence[Entry]) -> LinkErrors | None:
    """Return what all links together explain beside all basic laws of the drives and other effects.

    Args:
        regression: of all effects along the measured motion.
        chosen: the effects that were found.

    Returns:
        None where they explain less than `POLICY.unknown_most` of what the others leave.
    """
    links = _entries_of_links(regression)
    laws = [e for e in regression.entries if e.key.axis and effect_named(e.key.effect).search.basic]
    laws += [e for e in chosen if e.key.axis and e not in laws and not _is_of_links(e.key)]
    first = [k for e in laws for k in e.linear]
    columns = [*first, *(k for e in links for k in e.linear)]
    if len(columns) == len(first):
        return None
    blocks = [total(fold).pick(columns) for fold in regression.folds]
    size = np.sqrt(np.maximum(np.diag(total(blocks).gram), 0.0))
    there, size = size > 0.0, np.where(size > 0.0, size, 1.0)
    blocks = [b.scaled(1.0 / size) for b in blocks]
    own, eye = np.arange(len(columns)) < len(first), np.eye(len(columns))
    ridge = np.diag(np.where(there, 1e-9, 1.0))
    beside = left_out(blocks, np.diag(np.where(own, 0.0, 1.0)), _PENALTIES, ridge)
    bare = list(range(len(first)))
    alone = left_out([b.pick(bare) for b in blocks], eye[own][:, own], np.zeros(1), ridge[own][:, own])
    noise = float(regression.floor.sum()) * sum(b.samples for b in blocks) / len(regression.floor)
    share = min((alone.left - beside.left) / max(alone.left - noise, 1e-300), 1.0)
    if share < POLICY.unknown_most:
        return None
    return LinkErrors((beside.whole / size)[len(first) :], share)


def without_link_errors(
    errors: LinkErrors, regression: Regression, data: Data
) -> tuple[Recording, ...] | None:
    """Return recordings without the torque that errors of links do; None where no torque was recorded."""
    linearisation, names = regression.linearisation, [scored_torque(r) for r in data.recordings]
    if None in names:
        return None
    columns, out = columns_of_links(regression), []
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


def columns_of_links(regression: Regression) -> list[SensitivityColumn]:
    """Return what errors of the masses of all links, in all forms, add to the torque along the motion."""
    linearisation = regression.linearisation
    motions = needing(linearisation)
    entries = _entries_of_links(regression)
    return [c for e in entries for c in linearisation.columns(e.key, e.shape, motions)[0]]


def _entries_of_links(regression: Regression) -> Chosen:
    return tuple(e for e in regression.entries if e.key.axis and _is_of_links(e.key))


def _is_of_links(key: EffectKey) -> bool:
    return kinds.is_additive(effect_named(key.effect))
