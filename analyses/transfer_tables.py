"""Tables of the transfer study: on the screen, as Markdown and as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape

from workbench import report
from workbench.core.files import write_whole
from workbench.report.layout import table as new_table

_WIDTH = 190  # columns of the screen: a log file has no width of its own


def spread(values: Sequence[float] | np.ndarray, digits: int = 4, scale: float = 1.0) -> str:
    """Mean and sample standard deviation, ``0.0271 ± 0.0004``; of one value only that."""
    x = scale * np.asarray(values, float)
    x = x[np.isfinite(x)]
    if not len(x):
        return "–"
    mean = f"{x.mean():.{digits}f}"
    return mean if len(x) == 1 else f"{mean} ± {x.std(ddof=1):.{digits}f}"


def show(folder: Path, name: str, title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Print a table and write ``name.md``; columns but the first are right-aligned.

    Returns:
        The table as Markdown.
    """
    shown = new_table(escape(columns[0]), *((escape(c), "right") for c in columns[1:]))
    shown.title = title
    for row in rows:
        shown.add_row(*map(escape, row))
    report.print_table(shown, Console(width=_WIDTH, highlight=False))
    lines = [
        "| " + " | ".join(cells) + " |" for cells in (columns, ["---"] + ["---:"] * (len(columns) - 1), *rows)
    ]
    text = f"{title}\n\n" + "\n".join(lines) + "\n"
    write_whole(folder / f"{name}.md", text, force=True)
    return text


def write_csv(path: Path, rows: Sequence[dict[str, object]]) -> None:
    """All numbers, one row a trial; columns are the keys of the first."""
    names = list(rows[0])
    cells = [
        [f"{v:.6g}" if isinstance(v, float) else str(v).replace(",", ";") for v in row.values()]
        for row in rows
    ]
    write_whole(path, "\n".join(",".join(line) for line in (names, *cells)) + "\n", force=True)
