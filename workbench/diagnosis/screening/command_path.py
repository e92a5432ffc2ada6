"""The command path of a drive: measured torque against logged command, independent of the loop."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import SignalStage, contains, effect_named, kinds
from workbench.models import Placement

from ..hypothesis import Fit
from ..policy import POLICY
from .candidate import Candidate
from .sensitivity import Linearisation

#: What a drive's measured torque is off its command, and what a limit takes away of it, row by row; and the
#: share that this drive has of what all are off.
_Passed = tuple[np.ndarray, np.ndarray, float] | None


def by_command_path(
    linearisation: Linearisation, candidates: Iterable[Candidate], without: float
) -> list[Candidate]:
    """Return candidates with limits estimated from command and measured torque, if the loop's estimate is
    worse.

    A loop that is far beyond a limit is not the linear one that screening closes about its motion: what the
    limit took away would come back many times over. But the command that was logged is the true one. And of
    two forms of a limit it may leave only one.

    Args:
        linearisation: the model that lacks something, on the recordings.
        candidates: as screened.
        without: test loss without any of them.
    """
    passed = {c.key: (c, _passed(linearisation, c.key, c.shape)) for c in candidates}

    def refuted(key: EffectKey) -> bool:
        kin = (other for other in passed if contains(other, key) or contains(key, other))
        return any(_far_worse(passed[key][1], passed[other][1]) for other in kin)

    return [_told(c, own, without) for key, (c, own) in passed.items() if not refuted(key)]


def _told(candidate: Candidate, passed: _Passed, without: float) -> Candidate:
    if passed is None:
        return candidate
    off, taken, share = passed
    before, after = float(np.sum(off**2)), float(np.sum((off - taken) ** 2))
    left = after / before if before > 0.0 else 1.0
    if left >= POLICY.limit_left:
        return candidate
    # it takes nothing off what other drives lack
    return replace(candidate, test_loss=min(candidate.test_loss, (1.0 - share * (1.0 - left)) * without))


def off_command_path(linearisation: Linearisation, candidate: Candidate, found: Fit) -> bool:
    """Return whether a fit moved away from a limit that the command path shows, by more than noise.

    A loop at its limit may throw runs about so much that noise rules what fits them best.
    """
    applied = next((a for a in found.hypothesis.free if a.key == candidate.key), None)
    shapes = (candidate.shape, {**candidate.shape, **applied.values} if applied else candidate.shape)
    read, fitted = (_passed(linearisation, candidate.key, shape) for shape in shapes)
    if read is None or fitted is None:
        return False
    own, now = (float(np.sum((off - taken) ** 2)) for off, taken, _ in (read, fitted))
    return now - own > POLICY.sure**2 * own / len(read[0])


def _far_worse(one: _Passed, other: _Passed) -> bool:
    if one is None or other is None:
        return False
    limited = (one[1] != 0.0) | (other[1] != 0.0)
    left, best = (float(np.sum((off - taken)[limited] ** 2)) for off, taken, _ in (one, other))
    return left > POLICY.far_worse * best


def _passed(linearisation: Linearisation, key: EffectKey, shape: Mapping[str, float]) -> _Passed:
    """Return all recordings' rows (N,) of command and torque; None for effects that are no limit or without
    measured torque.
    """
    effect, place = effect_named(key.effect), Placement.of(linearisation.model, key)
    if (
        effect.stage is not SignalStage.COMMAND
        or not kinds.by_finite_difference(effect)
        or place is None
        or not shape
    ):
        return None
    every, measured, taken = [], [], []
    for motion in linearisation.motions:
        tap = effect.response(motion, linearisation.model, place, shape).tap
        off = motion.line.off_command
        if off is None or tap is None:
            return None
        every.append(off)
        measured.append(motion.line.measured)
        taken.append(tap[:, place.index])
    off = np.concatenate(every)
    squares = np.sum(off**2, axis=0) / np.maximum(np.var(np.concatenate(measured), axis=0), 1e-300)
    share = float(squares[place.index] / squares.sum()) if squares.any() else 1.0
    return off[:, place.index], np.concatenate(taken), share
