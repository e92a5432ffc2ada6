"""Layout of tables in the terminal: readable at 80 columns, without colour, and in a log file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich import box
from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from .numbers import plain


def print_table(renderable: RenderableType, console: Console | None = None) -> None:
    """Print to standard output; plain text where that is no terminal or NO_COLOR is set."""
    (console or Screen(highlight=False)).print(renderable, soft_wrap=False)


class Screen(Console):
    """A console on which names from elsewhere are plain text: no markup, no control characters."""

    def __init__(self, **options: Any) -> None:
        super().__init__(markup=False, emoji=False, **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterator[Segment]:
        """Return the printed segments, made printable."""
        for segment in super().render(renderable, options):
            if segment.control or segment.text.isprintable():
                yield segment
            else:
                yield Segment("\n".join(map(plain, segment.text.split("\n"))), segment.style)


def table(*columns: str | tuple[str, str]) -> Table:
    """Return an empty table with these columns; a column may be ``(name, justify)``."""
    out = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="dim", show_edge=False)
    for c in columns:
        name, justify = c if isinstance(c, tuple) else (c, "left")
        out.add_column(name, justify=justify, no_wrap=justify == "right")  # type: ignore[arg-type]
    return out


def text(content: str) -> Text:
    """Return a string as plain text: no markup, no control characters."""
    return Text(plain(content) if content.strip() == content else content)


def verdict(sentence: str, good: bool) -> Text:
    """Return the sentence above a table; green if nothing has to be done."""
    return Text(sentence, style="bold green" if good else "bold")
