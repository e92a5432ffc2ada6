"""Whether effects that explain the recordings may be named: they are significant and no other law fits."""

from __future__ import annotations

from collections.abc import Collection

from workbench.core import EffectKey
from workbench.effects import effect_named, kinds

from .data import Data
from .evidence.residual_evidence import ResidualEvidence
from .hypothesis import Fit
from .policy import POLICY
from .significance import is_significant


def may_be_named(found: Fit, data: Data, certain: Collection[EffectKey]) -> bool:
    """Return whether the explanation is significant and does not merely imitate the torque of another law.

    Args:
        found: the explanation.
        data: what it explains.
        certain: effects of it that were compared with any curve over their quantities. If they are several,
            a rest that follows a position takes the names of none of them.
    """
    significant = all(is_significant(a) for a in found.hypothesis.free)
    another = not are_several(certain) and bool(axes_of_another_shape(found, data))
    return significant and not another and not _far_off_contact(found, data)


def are_several(certain: Collection[EffectKey]) -> bool:
    """Return whether effects that are certain, on more than one axis, are too many for one other cause."""
    return len(certain) >= POLICY.certain_effects and len({key.axis for key in certain}) > 1


def axes_of_another_shape(found: Fit, data: Data) -> frozenset[str]:
    """Return the axes whose residual still depends on positions, if a position-dependent torque was found.

    A spring of another law, or one across two axes, is followed a long way by springs and cogging together.
    """
    added = found.hypothesis.free
    there = any(kinds.depends_on(effect_named(a.key.effect)) == ("position",) for a in added)
    return ResidualEvidence(data, found).following_positions if there else frozenset()


def _far_off_contact(found: Fit, data: Data) -> bool:
    """Return whether a search with contacts that make and break ends well above the noise.

    A foot a millimetre off is many newtons, nearly all of which any other way to lift it takes off as well.
    """
    error, floor = data.score(found.mean_squares), data.score(data.floor)
    return not data.replay.smooth and error > POLICY.ground_error * floor
