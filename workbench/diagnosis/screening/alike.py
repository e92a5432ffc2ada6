"""One size for an effect on all joints of one design, where the recordings agree with that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .selection import Selection, gain_of, selection_of
from .stepwise_regression import grown, least_gain, without_needless
from .torque_regression import Regression, Solution


def in_common(now: Selection, regression: Regression) -> Selection:
    """Return the selection with one size for what joints of one design share, and what only all of them show.

    Left and right legs were built alike: where their own sizes explain hardly more than a common one, that is
    simpler, and it is known better. Joints whose own sizes explain more keep them.
    """
    if not regression.alike:
        return now
    for entry in regression.alike:
        keys = {m.key for m in entry.alike}
        own = [e for e in now.chosen if e.key in keys]
        if not own:
            continue
        rest = tuple(e for e in now.chosen if e not in own)
        common = selection_of((*rest, entry), regression)
        lost = gain_of(now.solution, common.solution, regression)
        total, other = (float(s.solution.test_loss.sum()) for s in (now, common))
        if (lost < least_gain((entry,), regression)).all() and (len(own) > 1 or other < total):
            now = common
    now = without_needless(grown(now, regression, regression.alike), regression)
    return _apart(now) if now.chosen else now


def _apart(now: Selection) -> Selection:
    """Return the selection with one effect per joint, and which of them share a size."""
    ends, found = np.cumsum([len(e.linear) for e in now.chosen])[:-1], now.solution
    parts = np.split(np.vstack([found.coefficients, found.each]), ends, axis=1)
    pairs = [(m, own) for e, own in zip(now.chosen, parts, strict=True) for m in e.members]
    both = np.hstack([own for _, own in pairs])
    solution = Solution(both[0], found.validated, found.test_loss, both[1:])
    shared = tuple(frozenset(m.key for m in e.alike) for e in now.chosen if e.alike)
    return replace(now, chosen=tuple(m for m, _ in pairs), solution=solution, shared=shared)
