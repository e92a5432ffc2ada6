"""Where an error is, as the tables of a page divide it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from workbench.core import Share

from .numbers import percent, plain, short

_QUANTITIES = ("speed", "position", "frequency", "time")
_ROWS = 6


def share_groups(shares: Iterable[Share]) -> list[dict[str, Any]]:
    """Return shares of the excess in groups: by speed, position, frequency and time."""
    groups: dict[str, list[dict[str, str]]] = {}
    for s in sorted(shares, key=lambda s: -s.share):
        low, high = s.range
        groups.setdefault(s.quantity, []).append(
            {
                "axis": plain(s.axis),
                "signal": plain(s.signal).replace("_measured", ""),
                "range": f"{short(low)} to {short(high)} {plain(s.unit)}",
                "share": percent(s.share),
                "width": bar_width(s.share),
            }
        )
    order = [q for q in _QUANTITIES if q in groups] + [q for q in groups if q not in _QUANTITIES]
    return [{"quantity": plain(q), "rows": groups[q][:_ROWS]} for q in order]


def bar_width(share: float) -> str:
    """Return the width of the bar of a share [%]."""
    return f"{100 * min(1.0, max(0.0, share if share == share else 0.0)):.1f}"
