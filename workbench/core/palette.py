"""Colours and line styles of all pictures, in one place, so that measured data look the same everywhere.

Okabe and Ito's palette, which people with any kind of colour vision tell apart; lines differ in dash too, so
that a grey printer loses nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

#: Name to colour on light and on dark paper.
COLOURS: dict[str, tuple[str, str]] = {
    "paper": ("#fdfdfc", "#15181b"),
    "ink": ("#1a1c1e", "#e7e9eb"),
    "quiet": ("#5b6168", "#a3aab1"),
    "rule": ("#e2e4e7", "#2e3439"),
    "soft": ("#f3f4f5", "#1e2327"),
    "before": ("#d55e00", "#f0a03c"),
    "after": ("#0072b2", "#62bbee"),
    "noise": ("#8a9096", "#7d858c"),
    "measured": ("#868c92", "#6d757c"),  # 3:1 on paper and on soft ground
    "good": ("#00745a", "#4cc9a4"),
    "accent": ("#0067a3", "#7cc4f0"),
    "fifth": ("#a8457f", "#e08fbd"),
}


@dataclass(frozen=True)
class Line:
    """The style of a curve: name of its colour, dashes and gaps [points] (none: solid), width [points]."""

    colour: str
    dash: tuple[float, ...] = ()
    width: float = 1.3

    @property
    def light(self) -> str:
        """Return its colour on light paper."""
        return COLOURS[self.colour][0]

    def drawn(self) -> dict[str, Any]:
        """Return keyword arguments for matplotlib's lines."""
        return {"color": self.light, "lw": self.width, "ls": (0, self.dash) if self.dash else "-"}


#: What a curve shows to how it looks. ``before``: the model as given; ``after``: with effects added.
LINES: dict[str, Line] = {
    "measured": Line("measured", (), 3.2),
    "before": Line("before", (4.4, 1.8), 1.1),
    "after": Line("after", (), 1.3),
    "closed_chain": Line("ink", (), 1.6),
    "fit": Line("after", (), 1.3),
    "kin_only": Line("before", (5.0, 2.1), 1.3),
    "s3n_act": Line("good", (1.3, 1.6), 1.3),
    "s3n_full": Line("after", (7.8, 2.0, 1.3, 2.0), 1.3),
    "s3n_full_paper": Line("quiet", (12.0, 3.0), 1.2),
    "exact": Line("fifth", (2.2, 2.2), 1.1),
}
