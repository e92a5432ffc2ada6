"""Sets of effects that are missing together: solved in one linearised loop, and tested after their fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..acceptance import degrades_holdout, explains_most
from ..data import Data
from ..hypothesis import Fit
from ..screening.candidate import Candidate
from ..screening.equations import Entry, Equations, bounds_of
from ..screening.sensitivity import Linearisation
from ..significance import cancel_each_other, identifiable


def solved_together(
    entries: Sequence[Entry], linearisation: Linearisation, whole: Equations
) -> tuple[float, tuple[Candidate, ...]]:
    """Return the loss of effects on data they were not fitted on, and each effect with its coefficients."""
    test_loss, solution = whole.judged(entries, bounds_of(linearisation, entries))
    parts = np.split(solution, np.cumsum([len(e.linear) for e in entries])[:-1])
    found = (Candidate(e.key, x, e.shape, test_loss) for e, x in zip(entries, parts, strict=True))
    return test_loss, tuple(found)


def is_sound(found: Fit, linearisation: Linearisation, data: Data, start: Fit) -> bool:
    """Return whether effects explain most, each is identifiable, and none cancels another or degrades the
    holdout.
    """
    return (
        explains_most(found, start, data)
        and identifiable(linearisation, found)
        and not cancel_each_other(linearisation, found)
        and not degrades_holdout(found, start, data)
    )
