"""Directions in coordinates of any number, as plain float code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import itemgetter

Vector = list[float]


class Along:
    """A direction d (n,).

    Attributes:
        vector: d itself.
        terms: its coordinates that are not zero, as (index, factor).
        read: the component of a vector along it, d . x.
    """

    def __init__(self, direction: Sequence[float]) -> None:
        self.vector = list(direction)
        self.terms = tuple((i, d) for i, d in enumerate(direction) if d)
        self.read: Callable[[Vector], float] = _reader(self.terms)


def _reader(terms: tuple[tuple[int, float], ...]) -> Callable[[Vector], float]:
    if len(terms) == 1 and terms[0][1] == 1.0:
        return itemgetter(terms[0][0])  # by far the fastest, and most directions are of this kind
    return lambda vector: sum([d * vector[i] for i, d in terms])
