"""The part of a mechanism's limits that can be used: ranges in files often go on past dead points.

From a posture amid what is reached a box grows face by face until the limits, or until a posture on its face
cannot be reached or is near a dead point: one where the loops no longer determine the drives, or the drives
no longer the joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from workbench.core import InputError
from workbench.core.closure import Posture
from workbench.models import Model

from .posture import MOST_DRIVES, PostureDependent
from .posture_closure import LoopClosure, workspace

#: Of its usual value: what is less is near a dead point.
_SHARE = 0.5
_STEPS = 24  # of the limits' width, on each way from the start
_FIRST, _FINEST = 1 / 8, 1 / 64  # steps of a face, of the width of the limits
_FACE = {1: 1, 2: 5, 3: 3}  # postures tried on a face, for each of its axes
_DIGITS = 3  # of what is said, and written
_TRIES, _BACK = 4, 0.05  # times that sides are drawn in, and by how much of the box


@dataclass(frozen=True)
class Reach:
    """The limits within which a mechanism can be used.

    Attributes:
        box: lower and upper limit of each serial joint (n, 2) [rad or m].
        left_out: a line for each part of the stated limits that is not in it, with the reason.
    """

    box: np.ndarray
    left_out: tuple[str, ...] = ()

    def of(self, model: Model) -> Model:
        """Return the model with these limits."""
        assert model.closed_chain is not None
        limits = tuple((float(low), float(high)) for low, high in self.box)
        return replace(model, closed_chain=replace(model.closed_chain, limits=limits))


def reach(model: Model, kept: Sequence[str] = ()) -> Reach:
    """Return the stated limits if all of them can be used, else the box inside them that can.

    Args:
        model: its transmission changes with the posture; of more than three drives limits are as stated.
        kept: serial joints whose limits stay as they are, whatever that does to the others.

    Raises:
        InputError: no closed chain or limits, its loops do not close, or no box can be found.
    """
    stated = workspace(model)
    if model.size > MOST_DRIVES:
        return Reach(stated)
    growth = _Growth(model, stated, kept)
    box, stopped = growth.grown()
    if np.array_equal(box, stated) or _usable(model, stated):
        return Reach(stated)
    for _ in range(_TRIES):
        inward = np.where(box == stated, box, _rounded(box))
        if (inward[:, 0] < inward[:, 1]).all() and _usable(model, inward):
            return Reach(inward, _said(model, stated, inward, stopped))
        box = np.where(box == stated, box, box + _BACK * np.ptp(box, axis=1, keepdims=True) * [1.0, -1.0])
    raise InputError(
        "no part of the limits about the start posture is free of dead points", file=model.source,
        column="closed_chain.limits", remedy="give other limits, or a start posture amid them",
    )  # fmt: skip


class _Growth:
    """A box in the limits that grows about a posture."""

    def __init__(self, model: Model, stated: np.ndarray, kept: Sequence[str]) -> None:
        self._stated, self._width = stated, np.ptp(stated, axis=1)
        self._loops = LoopClosure(model)
        self._origin = self._loops.start
        self._kept = [i for i, name in enumerate(model.joints) if name in kept]
        ways = [[self._origin, *self._way(i)] for i in range(model.size)]
        # along a joint that turns no loop all is as at the start, which may be near a dead point: there the
        # loops have a small margin, and the drives a large ratio
        by_way = np.array([np.median([np.abs(self._measures(p)) for p in way], axis=0) for way in ways])
        side = np.sign(self._measures(self._origin)[1])
        self._usual = np.array([by_way[:, 0].max(), side * by_way[:, 1].min()])
        if self._why(self._origin):
            every = [p for way in ways for p in way]
            self._origin = max(every, key=lambda p: float(min(self._measures(p) / self._usual)))

    def grown(self) -> tuple[np.ndarray, dict[tuple[int, int], str]]:
        """The box (n, 2), and for each face (joint, side) that stopped inside the limits the reason."""
        box = np.stack([self._origin.q, self._origin.q], axis=1)
        box[self._kept] = self._stated[self._kept]
        step = {(i, side): _FIRST for i in range(len(box)) if i not in self._kept for side in (0, 1)}
        stopped: dict[tuple[int, int], str] = {}
        while step:
            for (i, side), share in list(step.items()):
                way = (-1.0, 1.0)[side] * share * self._width[i]
                tried = box.copy()
                tried[i, side] = np.clip(box[i, side] + way, *self._stated[i])
                why = self._face(tried, i, side)
                if not why:
                    box = tried
                    if tried[i, side] == self._stated[i, side]:
                        del step[i, side]
                elif share > _FINEST:
                    step[i, side] = share / 2.0
                else:
                    stopped[i, side] = why
                    del step[i, side]
        return box, stopped

    def _face(self, box: np.ndarray, axis: int, side: int) -> str:
        """Return why a posture on a face cannot be used; empty if all can."""
        count = _FACE[len(box)]
        ends = [
            [box[i, side]] if i == axis else np.linspace(box[i, 0], box[i, 1], count if np.ptp(box[i]) else 1)
            for i in range(len(box))
        ]
        whys = (self._why(self._loops.along(self._origin, np.array(q))) for q in product(*ends))
        return next((why for why in whys if why), "")

    def _way(self, joint: int) -> list[Posture]:
        """Return postures straight from the start to both limits of a joint, as far as they can be closed."""
        found = []
        for end in self._stated[joint]:
            at: Posture | None = self._origin
            for x in np.linspace(self._origin.q[joint], end, _STEPS + 1)[1:]:
                q = self._origin.q.copy()
                q[joint] = x
                at = None if at is None else self._loops.along(at, q)
                if at is None or at.slope is None:
                    break
                found.append(at)
        return found

    def _measures(self, at: Posture) -> np.ndarray:
        """Return distances from a dead point of loops and drives; a change of sign is one passed."""
        assert at.slope is not None
        return np.array([at.margin, float(np.linalg.det(at.slope[self._loops.drives]))])

    def _why(self, at: Posture | None) -> str:
        if at is None or at.slope is None:
            return "loops do not close"
        loops, drives = self._measures(at) / self._usual
        if loops < _SHARE:
            return "loops come near a dead point"
        return "drives come near a dead point" if drives < _SHARE else ""


def _usable(model: Model, box: np.ndarray) -> bool:
    """Return whether everything that is derived from a mechanism can be derived in a box."""
    try:
        PostureDependent(Reach(box).of(model), tolerance=1e-9)
    except InputError:
        return False
    return True


def _rounded(box: np.ndarray) -> np.ndarray:
    """Return both ends moved inwards to a number with few digits."""
    scale = 10.0**_DIGITS
    return np.stack([np.ceil(scale * box[:, 0]), np.floor(scale * box[:, 1])], axis=1) / scale


def _said(
    model: Model, stated: np.ndarray, box: np.ndarray, stopped: dict[tuple[int, int], str]
) -> tuple[str, ...]:
    lines = []
    for i, name in enumerate(model.joints):
        for side in (0, 1):
            if box[i, side] != stated[i, side]:
                low, high = sorted((box[i, side], stated[i, side]))
                why = stopped.get((i, side), "loops come near a dead point")
                lines.append(f"{name} from {low:.4g} to {high:.4g}, where {why}")
    return tuple(lines)
