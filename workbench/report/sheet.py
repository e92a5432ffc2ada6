"""Parts of a page for commands whose result is neither a comparison nor a diagnosis.

A verdict, key numbers, and sections of sentences, tables and drawings; `sheet_page` lays them out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from workbench.core.palette import LINES

from .numbers import plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LARGER = 1.25  # lines on a screen than on paper

#: Look of a curve: colour (a variable of the style sheet), dash, width. Lines are told apart without colour.
STYLES: dict[str, tuple[str, str, float]] = {
    **{
        name: (
            look.colour,
            ",".join(f"{_LARGER * d:g}px" for d in look.dash) or "solid",
            _LARGER * look.width,
        )
        for name, look in LINES.items()
    },
    "measured": ("measured", "dot", 5.0),
    "noise": ("noise", "band", 8.0),
    "limit": ("noise", "2px,4px", 2.0),
}


@dataclass(frozen=True, eq=False)
class Curve:
    """One line or set of points of a panel.

    Attributes:
        name: in the key.
        style: one of `STYLES`; another name looks like ``"fit"``.
        x, y: shape (N,); NaN leaves a gap.
        low, high: a band, (N,), or None.
    """

    name: str
    style: str
    x: np.ndarray
    y: np.ndarray | None = None
    low: np.ndarray | None = None
    high: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Row:
    """One diagram of a panel; those of a panel are above each other and share the x axis."""

    label: str
    curves: tuple[Curve, ...]
    log: bool = False


@dataclass(frozen=True, eq=False)
class Panel:
    """Diagrams over one x axis.

    Attributes:
        title: over it.
        x_label: with unit.
        rows: top first.
        summary: the same in a sentence, for who does not see it.
        log: of the x axis.
        wide: takes a whole line.
    """

    title: str
    x_label: str
    rows: tuple[Row, ...]
    summary: str
    log: bool = True
    wide: bool = False


@dataclass(frozen=True, eq=False)
class Drawing:
    """Panels with one legend and one caption."""

    panels: tuple[Panel, ...]
    caption: str


@dataclass(frozen=True, eq=False)
class Section:
    """One part of the page: sentences, a picture with its description, then tables, drawings, and a list."""

    id: str
    title: str
    sentences: tuple[str, ...] = ()
    tables: tuple[SheetTable, ...] = ()
    drawings: tuple[Drawing, ...] = ()
    remarks: tuple[str, ...] = ()
    picture: tuple[Figure, str] | None = None


@dataclass(frozen=True, eq=False)
class Sheet:
    """Content of a page.

    Attributes:
        kind, model: "`kind` of `model`" is the page's name.
        tone: ``"consistent"`` where nothing is to be done, ``"missing_effect"``, or ``"unexplained"``.
        sentence: the verdict.
        lines: up to three more sentences.
        key_numbers: label, number, remark.
        sections: the rest; where scripts do not run, their first drawing stands as a picture.
    """

    kind: str
    model: str
    tone: Literal["consistent", "missing_effect", "unexplained"]
    sentence: str
    lines: tuple[str, ...] = ()
    key_numbers: tuple[tuple[str, str, str], ...] = ()
    sections: tuple[Section, ...] = ()


@dataclass(frozen=True)
class SheetTable:
    """A table.

    Attributes:
        caption: what it shows.
        header: of the columns; ``>`` in front puts a column of numbers to the right.
        rows: cells; the first of a row names it.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def table_parts(table: SheetTable) -> dict[str, Any]:
    """Return caption, header (text, and whether it is right-aligned) and rows, as plain text."""
    return {
        "caption": plain(table.caption),
        "header": [(plain(h.lstrip(">")), h.startswith(">")) for h in table.header],
        "rows": [[plain(cell) for cell in row] for row in table.rows],
    }
