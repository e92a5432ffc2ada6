"""How many times the CPU time of one piece of work another takes, measured alternately in the same process.

Seconds tell more of the machine and of what else it does than of the code; a ratio of CPU times of two pieces
of work that take turns tells of the code.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

_SHORTEST = 0.02  # s of CPU time that is timed at once: what is shorter is done several times


@dataclass(frozen=True)
class Ratio:
    """A median of ratios with the least and the most of them."""

    median: float
    least: float
    most: float
    repeats: int

    def __str__(self) -> str:
        return f"{self.median:.3g} ({self.least:.3g} to {self.most:.3g}, {self.repeats} times)"


def spread(values: np.ndarray | list[float]) -> Ratio:
    """Of ratios that were measured."""
    x = np.asarray(values, float)
    return Ratio(float(np.median(x)), float(x.min()), float(x.max()), len(x))


def times_as_long(work: Callable[[], object], than: Callable[[], object], repeats: int = 5) -> Ratio:
    """CPU time of `work` over that of `than`, which take turns; once each beforehand, uncounted."""
    counts = [_often_enough(each) for each in (work, than)]
    found = []
    for _ in range(repeats):
        mine, other = (_cpu(each, count) for each, count in zip((work, than), counts, strict=True))
        found.append(mine / other)
    return spread(found)


def _often_enough(work: Callable[[], object]) -> int:
    work()
    return max(1, int(np.ceil(_SHORTEST / max(_cpu(work, 1), 1e-6))))


def _cpu(work: Callable[[], object], count: int) -> float:
    """CPU seconds of doing it once, all threads of this process together."""
    begun = time.process_time()
    for _ in range(count):
        work()
    return (time.process_time() - begun) / count
