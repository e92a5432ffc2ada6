"""The punctuality of a loop."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Punctuality:
    """Counts of ticks.

    Attributes:
        round_trips: from the first command of a tick to the last answer [s]; only where all answered.
        late: how late each tick began [s].
        skipped: ticks that were skipped because the one before took too long.
        incomplete: ticks in which not every drive answered.
        stalls: times that the loop itself was held up so long that it had to look anew.
        again: commands sent once more within their tick.
        counts: frames that came in, by what they were.
    """

    round_trips: list[float] = field(default_factory=list)
    late: list[float] = field(default_factory=list)
    skipped: int = 0
    incomplete: int = 0
    again: int = 0
    stalls: int = 0
    counts: Counter[str] = field(default_factory=Counter)

    @property
    def ticks(self) -> int:
        """Return the number of ticks."""
        return len(self.late)

    @property
    def missed(self) -> float:
        """Return the share of ticks that were skipped, or started more than half a millisecond late."""
        total = self.ticks + self.skipped
        return (self.skipped + sum(late > 0.5e-3 for late in self.late)) / total if total else 0.0

    def percentile(self, part: float) -> float:
        """Return a percentile of the round trips [s]; NaN if there are none."""
        return float(np.percentile(self.round_trips, part)) if self.round_trips else float("nan")

    def summary(self) -> Mapping[str, Any]:
        """Return the numbers for programs and status lines; times in milliseconds."""
        return {
            "ticks": self.ticks,
            "skipped": self.skipped,
            "missed_share": self.missed,
            "incomplete": self.incomplete,
            "stalls": self.stalls,
            "sent_again": self.again,
            "round_trip_ms": {"p50": 1e3 * self.percentile(50), "p99": 1e3 * self.percentile(99)},
            "frames": dict(self.counts),
        }
