"""The set that a change of the diagnosis is held against: 120 cases of one seed, in mixed order.

The virtual leg and the second one take turns, so that any beginning has as many of both and a fair sample of
kinds.
"""

from __future__ import annotations

from .cases import Case, all_cases, interleaved
from .second.cases import second_cases

SEED = 43
EACH = 60  # of either simulator
QUICK = 30  # of both together


def oracle_cases() -> list[Case]:
    """The 120 cases."""
    return interleaved([all_cases(SEED)[:EACH], second_cases(SEED)])
