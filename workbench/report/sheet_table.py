"""A table of a page: its content, and its parts for the templates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .numbers import plain


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
