"""Unnamed columns in groups: all positions, then all speeds, in the same order of joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

_LIKE = 0.8  # likeness of a speed and the slope of its position, from which their places may tell the rest
_CLEARER = 0.5  # of what the next best pair lacks


def by_column_order(
    pairs: Mapping[str, str], names: Sequence[str], likeness: Mapping[tuple[str, str], float]
) -> dict[str, str]:
    """Return position -> speed for neighbours of certain pairs, at the same distance if less similar.

    Args:
        pairs: position -> speed, as found by the numbers alone.
        names: all columns in the file's order.
        likeness: of each column's slope to each other column.
    """
    at = {name: k for k, name in enumerate(names)}
    steps = {at[b] - at[a] for a, b in pairs.items()}
    if len(steps) != 1 or not all(name.startswith("column_") for pair in pairs.items() for name in pair):
        return {}
    (step,) = steps
    out: dict[str, str] = {}
    for first, way in ((min(at[a] for a in pairs), -1), (max(at[a] for a in pairs), 1)):
        k = first + way
        while 0 <= k < len(names) and 0 <= k + step < len(names):
            taken = {*pairs, *pairs.values(), *out, *out.values()}
            a, b = names[k], names[k + step]
            if {a, b} & taken or not _belong(a, b, taken, likeness):
                break
            out[a] = b
            k += way
    return out


def _belong(a: str, b: str, taken: set[str], likeness: Mapping[tuple[str, str], float]) -> bool:
    """Whether no other pair with one of them comes near."""
    own = likeness.get((a, b), 0.0)
    others = (x for (p, v), x in likeness.items() if (p == a) != (v == b) and not {p, v} & taken)
    return own > _LIKE and 1.0 - own < _CLEARER * (1.0 - max(others, default=0.0))
