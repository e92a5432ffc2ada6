"""What command and measured torque of a drive say of each other, whatever the loop around them does."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from workbench.effects import Door, effect_named
from workbench.models import Placement

from .sensitivity import Scene

if TYPE_CHECKING:
    from .screen import Candidate

_LEFT = 0.5  # of what the channel's torque is off: an effect that leaves more is not what is seen there


def by_channel(scene: Scene, candidates: Iterable[Candidate], without: float) -> list[Candidate]:
    """Limits as the logged command and the torque behind it judge them, where the loop's estimate is worse.

    A loop that is far beyond a limit is not the linear one that screening closes about its motion: what the
    limit took away would come back many times over. But the command that was logged is the true one.

    Args:
        scene: the model that lacks something, on the recordings.
        candidates: as screened.
        without: judged error without any of them.
    """
    return [_told(scene, c, without) for c in candidates]


def _told(scene: Scene, candidate: Candidate, without: float) -> Candidate:
    effect, place = effect_named(candidate.key.effect), Placement.of(scene.model, candidate.key)
    if effect.door is not Door.COMMAND or not effect.by_runs or place is None or not candidate.shape:
        return candidate
    before = after = 0.0
    for motion in scene.motions:
        if motion.line.measured is None:
            return candidate
        off = (motion.line.measured - motion.line.passed[0])[:, place.index]
        tap = effect.response(motion, scene.model, place, candidate.shape).tap
        if tap is None:
            return candidate
        before += float(np.sum(off**2))
        after += float(np.sum((off - tap[:, place.index]) ** 2))
    left = after / before if before > 0.0 else 1.0
    return replace(candidate, judged=min(candidate.judged, left * without)) if left < _LEFT else candidate
