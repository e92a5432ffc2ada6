"""Rows of the page, and parts that give them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One figure: what is measured, over what, and what came out."""

    what: str
    over: str
    figure: str


@dataclass(frozen=True)
class Part:
    """Figures that are measured together.

    Attributes:
        name: in one word.
        title: for the page.
        about: what is done, in a sentence or two.
        measure: from whether to be quick to the rows; raises ImportError where something is not installed.
        command: that measures more of it.
    """

    name: str
    title: str
    about: str
    measure: Callable[[bool], list[Row]]
    command: str = ""


def table(rows: list[Row]) -> str:
    """In Markdown."""
    lines = [
        "| what | over | ratio: median (least to most) |",
        "|---|---|---|",
        *(f"| {row.what} | {row.over} | {row.figure} |" for row in rows),
    ]
    return "\n".join(lines)
