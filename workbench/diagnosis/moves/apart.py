"""Which effects are certain when the unknown part is removed: another part of the motion, another
frequency, or other masses of the links.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import effect_named, kinds
from workbench.models import Model, Placement

from ..adequacy.free_functions import Adequacy
from ..adequacy.laws import is_of_drives, laws_of
from ..adequacy.link_errors import link_errors, may_imitate_friction, without_link_errors
from ..adequacy.part_of_motion import Part, explained_part
from ..adequacy.strangers import rest_of
from ..adequacy.tones import without_tones
from ..data import Data
from ..hypothesis import Fit
from ..node import is_consistent
from ..problem import evaluated
from ..screening.torque_columns import regression_of
from .joint_fit import Certain, certain_of, freed_of


@dataclass(frozen=True, eq=False)
class Apart:
    """A way to set the unknown apart.

    Attributes:
        recordings: without it.
        may_follow: whether an effect may follow it there all the same.
        wanted: whether an effect is looked for there.
    """

    recordings: Sequence[Recording]
    may_follow: Callable[[EffectKey], bool]
    wanted: Callable[[EffectKey], bool] = lambda key: True


def certain_apart(found: Certain, start: Fit, data: Data, seed: int) -> Certain:
    """Return the certain effects found with the unknown part removed, if there are more, or if these are more
    nearly right; otherwise what was found.

    That is where noise is all that is left, or where free functions explain less than half as much beside
    them as before.

    Args:
        found: from all rows and all torques.
        start: without any effect, along the measured motion.
        data: of that motion.
        seed: of the noise simulations.
    """
    for way in _ways(found, data):
        freed, begun = freed_of(start, way.recordings, data, seed)
        regression = regression_of(begun, freed, way.wanted)
        there = certain_of(regression, begun, freed, whatever_is_left=True)
        if there is None:
            continue
        known = {k: a for k, a in there.known.items() if not way.may_follow(k)}
        before = {k for k in found.known if not way.may_follow(k)}
        alike = bool(known) and before == set(known)
        if before < set(known) or (
            alike and (is_consistent(freed, there.whole.mean_squares) or _are_better(known, found.known))
        ):
            whole = evaluated(there.whole.hypothesis, data.run([there.whole.hypothesis.model])[0], data)
            return replace(there, whole=whole, known=known, apart=True, by_links=found.by_links)
    return found


def _are_better(known: Mapping[EffectKey, Adequacy], before: Mapping[EffectKey, Adequacy]) -> bool:
    """Return whether free functions explain less than half as much beside some effects as they did before."""
    least, least_before = (min(own[key].share for key in known) for own in (known, before))
    return 1.0 - least < 0.5 * (1.0 - least_before)


def _ways(found: Certain, data: Data) -> Iterator[Apart]:
    linearisation = found.regression.linearisation
    laws = laws_of(found.whole, found.regression, data)
    part = explained_part(laws, [m.position for m in linearisation.motions])
    if part is not None:
        rows = zip(data.recordings, part.rows, strict=True)
        masked = [replace(r, valid=r.valid & own) for r, own in rows]
        keys = found.whole.hypothesis.keys
        yield Apart(
            masked,
            lambda key: _may_follow(key, part, linearisation.model),
            lambda key: not part.basic or key in keys or is_of_drives(key),
        )
    quiet = without_tones(laws, rest_of(found.whole, data)[0], data)
    if quiet is not None:
        yield Apart(quiet.recordings, lambda key: key in quiet.tonal)
    errors = link_errors(found.regression, found.chosen.chosen, data)
    guessed = errors and without_link_errors(errors, found.regression, data)
    if guessed:
        yield Apart(guessed, may_imitate_friction)


def _may_follow(key: EffectKey, part: Part, model: Model) -> bool:
    """Return whether an effect may follow another torque on a part of the motion.

    A constant does, a law of the position by which the part is known, and what one link's weight does. A body
    that several axes carry does not.
    """
    depends, place = kinds.depends_on(effect_named(key.effect)), Placement.of(model, key)
    if part.basic and not is_of_drives(key):
        return True
    if place is None:
        return False
    if not depends:
        return True
    turned = np.flatnonzero(np.abs(place.row @ np.linalg.inv(model.transmission)) > 1e-12)
    return "position" in depends and bool(part.drives & set(turned.tolist()))
