"""How a text table is written: separator, decimal mark, header, and which of its columns hold numbers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from workbench.core import InputError

#: Cells without a number: what programs write for one that is missing, and truth values.
EMPTY = ("", "nan", "null", "na", "n/a", "none", "#n/a", "-", "inf", "-inf", "true", "false")
LOOK = 60  # lines that show what kind of text it is

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_STYLES = ((";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", "."), (" ", ","), (" ", "."))


@dataclass(frozen=True)
class Style:
    """How a text table is written.

    Attributes:
        encoding: of the bytes.
        separator: between cells; ``" "`` stands for any run of blanks.
        decimal: ``.`` or ``,``.
        header: index of the line with names, or None.
        first: index of the first line of numbers.
        units: the unit row's cells, where there is one.
    """

    encoding: str
    separator: str
    decimal: str
    header: int | None
    first: int
    units: tuple[str, ...] = ()


def find_style(lines: list[str], encoding: str, path: Path) -> Style:
    """Return the separator, decimal sign and header under which most lines are similar rows of numbers.

    Args:
        lines: the file's first ones.
        encoding, path: of the file.

    Raises:
        InputError: under no reading is there a column of numbers.
    """
    best: tuple[float, Style] | None = None
    for separator, decimal in _STYLES:
        rows = [cells_of(line, separator) for line in lines if line.strip()]
        at = [i for i, line in enumerate(lines) if line.strip()]
        if len(rows) > 2 and len(lines) > LOOK:
            rows, at = rows[:-1], at[:-1]  # the last line may be cut
        for width, numeric, share in _widths(rows, decimal):
            good = [len(row) == width and _is_row(row, numeric, decimal) for row in rows]
            if not any(good):
                continue
            first = good.index(True)
            fractions = sum(decimal in cell for row in rows[first:] for cell in row)
            alike = sum(good[first:]) / len(good[first:])
            score = 100 * alike * share + min(width, 50) + (5 if fractions else 0)
            if best is None or score > best[0]:
                header, units = _above(rows[:first], at, width)
                best = score, Style(encoding, separator, decimal, header, at[first], units)
    if best is None:
        raise InputError(
            _why_no_table(lines), file=path, remedy="give one row per sample, two columns or more"
        )
    return best[1]


def _why_no_table(lines: list[str]) -> str:
    """Return what is wrong with lines that hold no table."""
    filled = sum(bool(line.strip()) for line in lines)
    if filled == 0:
        return "is empty"
    if filled == 1:
        return "has one line only, and no rows below it"
    return "has no two columns of numbers with one separator between them"


def _widths(rows: list[list[str]], decimal: str) -> Iterator[tuple[int, list[bool], float]]:
    """Numbers of cells that rows have, which columns hold numbers then, and the share of those.

    The later half of the rows tells: what stands above a table is text in columns of numbers.
    """
    counted = Counter(len(row) for row in rows if any(_is_number(cell, decimal) for cell in row))
    for width in counted:
        fitting = [row for row in rows if len(row) == width]
        numeric, known = [], 0
        for cells in zip(*fitting[len(fitting) // 2 :], strict=True):
            filled = [cell for cell in cells if cell.lower() not in EMPTY]
            numbers = sum(_is_number(cell, decimal) for cell in filled)
            numeric.append(2 * numbers >= len(filled))
            known += numeric[-1] and any(cells)
        empty = sum(not any(row[i] for row in fitting) for i in range(width))
        if width > 1 and known:
            yield width, numeric, known / max(1, width - empty)


def cells_of(line: str, separator: str) -> list[str]:
    """Return the cells of a line, without quotes; ``" "`` separates by any run of blanks."""
    line = line.lstrip("\ufeff")
    parts = line.split() if separator == " " else line.split(separator)
    return [part.strip().strip('"').strip() for part in parts]


def _is_number(cell: str, decimal: str) -> bool:
    return bool(_NUMBER.fullmatch(cell)) and ("." if decimal == "," else ",") not in cell


def _is_row(cells: list[str], numeric: list[bool], decimal: str) -> bool:
    """Whether the columns of numbers have some, and nothing else."""
    own = [cell for cell, counts in zip(cells, numeric, strict=True) if counts]
    numbers = sum(_is_number(cell, decimal) for cell in own)
    return numbers > 0 and numbers + sum(cell.lower() in EMPTY for cell in own) == len(own)


def _above(rows: list[list[str]], at: list[int], width: int) -> tuple[int | None, tuple[str, ...]]:
    """The header's line and the unit row, among the rows before the numbers."""
    fitting = [i for i, row in enumerate(rows) if len(row) in (width, width + 1) and _worded(row)]
    if not fitting:
        return None, ()
    last = fitting[-1]
    if len(fitting) > 1 and fitting[-2] == last - 1 and _looks_like_units(rows[last]):
        return at[last - 1], tuple(cell.strip("[]() ") for cell in rows[last])
    return at[last], ()


def _worded(row: list[str]) -> bool:
    return sum(bool(cell) and not _NUMBER.fullmatch(cell) for cell in row) > 0.5 * len(row)


def _looks_like_units(row: list[str]) -> bool:
    from ..units import known_unit

    cells = [cell.strip("[]() ") for cell in row]
    known = sum(cell in ("", "-", "1") or known_unit(cell) for cell in cells)
    return known >= 0.7 * len(cells) and any(known_unit(cell) for cell in cells)
