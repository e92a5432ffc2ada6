"""How shells and notebooks show a value: a few lines of text, the same as HTML, and a picture."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatch
from importlib import import_module
from typing import Any

Row = tuple[str, ...]


@dataclass(frozen=True)
class Summary:
    """A short description of a value.

    Attributes:
        title: what it is, or its verdict.
        told: its main numbers, one sentence; may be empty.
        tables: each with a head and rows of as many cells.
    """

    title: str
    told: str
    tables: Sequence[tuple[Row, Sequence[Row]]] = ()

    @property
    def text(self) -> str:
        """Return the lines for a shell."""
        lines = [self.title, *([self.told] if self.told else ())]
        for head, rows in self.tables:
            widths = [max(len(row[k]) for row in (head, *rows)) for k in range(len(head))]
            for row in (head, *rows) if rows else ():
                lines.append("  " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip())
        return "\n".join(lines)

    @property
    def html(self) -> str:
        """Return HTML; strings from files are escaped."""
        tables = "".join(_table(head, rows) for head, rows in self.tables if rows)
        told = f"<br>{html.escape(self.told)}" if self.told else ""
        return f"<div><p><strong>{html.escape(self.title)}</strong>{told}</p>{tables}</div>"


class Shown:
    """A value that shells and notebooks show in a few lines, and that has a picture.

    The module that says how is loaded by its name when it is needed: values know nothing of pages.
    """

    _shown_by = "workbench.report.notebook"

    def __repr__(self) -> str:
        return import_module(self._shown_by).summary(self).text

    def _repr_html_(self) -> str:
        return import_module(self._shown_by).summary(self).html

    def plot(self, **options: Any) -> Any:
        """A matplotlib figure of what matters most; `options` are those of the module's ``as_figure``."""
        return import_module(self._shown_by).as_figure(self, **options)


def by_kind(what: str) -> Any:
    """Return a function with which each kind of value registers how it is shown; it refuses all others.

    Args:
        what: every kind that is registered, in words.
    """

    @singledispatch
    def shown(value: Any) -> Any:
        raise TypeError(f"a {type(value).__name__} is no {what}")

    return shown


def _table(head: Row, rows: Sequence[Row]) -> str:
    top = "".join(f"<th>{html.escape(cell)}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(f'<td>{html.escape(c)}</td>' for c in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
