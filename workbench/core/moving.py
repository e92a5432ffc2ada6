"""Which loops of a mechanism move together: those that share a coordinate."""

from __future__ import annotations

from collections.abc import Sequence


def groups(movers: Sequence[Sequence[int]]) -> list[tuple[list[int], list[int]]]:
    """Return the loops by which coordinates they share: rows of the gap, and coordinates, of each group.

    Args:
        movers: of each row of the gap the coordinates that open or close it.
    """
    out: list[tuple[set[int], set[int]]] = []
    for row, own in enumerate(movers):
        rows, columns = {row}, set(own)
        for other in [each for each in out if each[1] & columns]:
            out.remove(other)
            rows, columns = rows | other[0], columns | other[1]
        out.append((rows, columns))
    return [(sorted(rows), sorted(columns)) for rows, columns in out]


def moving_with(movers: Sequence[Sequence[int]], coordinates: Sequence[int]) -> tuple[list[int], list[int]]:
    """Return rows of the gap and coordinates of all loops that move with some coordinates, these included.

    Args:
        movers: of each row of the gap the coordinates that open or close it.
        coordinates: positions in theta.
    """
    rows, columns = set[int](), set(coordinates)
    for own, others in groups(movers):
        if columns.intersection(others):
            rows.update(own)
            columns.update(others)
    return sorted(rows), sorted(columns)
