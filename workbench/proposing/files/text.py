"""Text tables of any kind: separator, decimal mark, encoding, preamble and unit row are found, not asked."""

from __future__ import annotations

import gzip
import io
import re
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv

from workbench.core import InputError
from workbench.core.bounds import check_cells, read_bounded

from ..table import Table

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_EMPTY = ("", "nan", "null", "na", "n/a", "none", "#n/a", "-", "inf", "-inf", "true", "false")
_LOOK = 60  # lines that show what kind of text it is


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


def read_text(path: Path) -> Table:
    """Read a text table.

    Raises:
        InputError: it is no text, too large, or has no rows of numbers.
    """
    raw = _raw(path)
    encoding = _encoding(raw, path)
    try:
        text = raw.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        problem = f"is no {encoding.upper()} text from byte {error.start} on"
        raise InputError(problem, file=path, remedy="check that the file is whole") from error
    lines = text.split("\n", _LOOK + 1)[: _LOOK + 1]
    style = _style(lines, encoding, path)
    names = _names(lines, style)
    body = "\n".join(text.split("\n")[style.first :]).strip("\n") + "\n"
    if style.separator == " ":
        body = re.sub(r"[ \t]+", " ", re.sub(r"(?m)^[ \t]+|[ \t]+$", "", body))
    check_cells(len(names) * body.count("\n"), path)
    columns, left_out = _columns(body, names, style, path)
    notes = [f"Column '{name}' holds text and is left out." for name in left_out]
    plain = (
        style.header == 0
        and style.first == 1
        and style.decimal == "."
        and style.separator in ",;\t"
        and encoding == "utf-8-sig"
        and len(set(names)) == len(names)
        and path.name.lower().endswith((".csv", ".csv.gz"))
    )
    if style.decimal == ",":
        notes.append("Numbers have a decimal comma.")
    if encoding not in ("utf-8-sig",):
        notes.append(f"The text is {encoding.upper()}.")
    units = {n: u for n, u in zip(names, style.units, strict=False) if u and n in columns}
    return Table(path, columns, units, plain, None, tuple(notes))


def _raw(path: Path) -> bytes:
    opener = gzip.open if path.name.lower().endswith(".gz") else open
    try:
        with opener(path, "rb") as file:
            return read_bounded(file, path)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError("cannot be read", file=path, remedy="check that the file is whole") from error


def _encoding(raw: bytes, path: Path) -> str:
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    start = raw[:4096]
    if len(start) > 8 and start[1::2].count(0) > 0.4 * len(start[1::2]):
        return "utf-16-le"
    if len(start) > 8 and start[::2].count(0) > 0.4 * len(start[::2]):
        return "utf-16-be"
    if b"\0" in start:
        raise InputError(
            "is neither a text table nor another format that is known",
            file=path,
            remedy="give .csv, .parquet, .mat, .npz, .mcap, a ROS 2 bag, a LeRobot data set or a CAN log",
        )
    try:
        raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _style(lines: list[str], encoding: str, path: Path) -> Style:
    """The reading under which most lines are rows of equally many numbers."""
    best: tuple[float, Style] | None = None
    for separator, decimal in (
        (";", ","),
        (";", "."),
        ("\t", ","),
        ("\t", "."),
        (",", "."),
        (" ", ","),
        (" ", "."),
    ):
        rows = [_cells(line, separator) for line in lines if line.strip()]
        at = [i for i, line in enumerate(lines) if line.strip()]
        if len(rows) > 2 and len(lines) > _LOOK:
            rows, at = rows[:-1], at[:-1]  # the last line may be cut
        numeric = [_is_row(row, decimal) for row in rows]
        if not any(numeric):
            continue
        width = max(len(r) for r, good in zip(rows, numeric, strict=True) if good)
        good = [ok and len(r) == width for r, ok in zip(rows, numeric, strict=True)]
        if width < 2 or not any(good):
            continue
        first = good.index(True)
        share = sum(good[first:]) / len(good[first:])
        fractions = sum(decimal in cell for row in rows[first:] for cell in row)
        score = share * 100 + min(width, 50) + (5 if fractions else 0)
        header, units = _above(rows[:first], at, width)
        style = Style(encoding, separator, decimal, header, at[first], units)
        if best is None or score > best[0]:
            best = score, style
    if best is None:
        raise InputError(
            "has no rows of numbers with one separator between them",
            file=path,
            remedy="give one row a sample, two columns or more",
        )
    return best[1]


def _cells(line: str, separator: str) -> list[str]:
    line = line.lstrip("\ufeff")
    parts = line.split() if separator == " " else line.split(separator)
    return [part.strip().strip('"').strip() for part in parts]


def _is_row(cells: list[str], decimal: str) -> bool:
    """Whether cells are numbers or empty; one may be text (a time stamp)."""
    other = "." if decimal == "," else ","
    numbers = sum(bool(_NUMBER.fullmatch(c)) and other not in c for c in cells)
    empty = sum(c.lower() in _EMPTY for c in cells)
    return numbers > 0 and numbers + empty >= len(cells) - (1 if len(cells) > 3 else 0)


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


def _names(lines: list[str], style: Style) -> list[str]:
    width = len(_cells(lines[style.first], style.separator))
    if style.header is None:
        return [f"column_{i + 1}" for i in range(width)]
    cells = _cells(lines[style.header].lstrip("\ufeff#%/ \t"), style.separator)
    cells = cells[-width:] if style.separator == " " else cells[:width]
    cells += [f"column_{i + 1}" for i in range(len(cells), width)]
    out: list[str] = []
    for i, name in enumerate(cells):
        name = name or f"column_{i + 1}"
        out.append(name if name not in out else f"{name}_{i + 1}")
    return out


def _columns(
    body: str, names: list[str], style: Style, path: Path
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Numbers by name, and names of columns that hold text."""
    keys = [f"c{i}" for i in range(len(names))]
    skipped: list[int] = []

    def skip(row: pacsv.InvalidRow) -> str:
        skipped.append(row.expected_columns)
        return "skip"

    try:
        table = pacsv.read_csv(
            io.BytesIO(body.encode()),
            # a thread that lets go of our objects while Python ends would end the process by a signal
            read_options=pacsv.ReadOptions(column_names=keys, use_threads=False),
            parse_options=pacsv.ParseOptions(delimiter=style.separator, invalid_row_handler=skip),
            convert_options=pacsv.ConvertOptions(column_types=dict.fromkeys(keys, pa.string())),
        )
    except pa.ArrowInvalid as error:
        raise InputError(
            f"cannot be read: {error}", file=path, remedy="check that the file is whole"
        ) from error
    if table.num_rows == 0:
        raise InputError("the table has no rows", file=path, remedy="record again or give another file")
    if len(skipped) > 0.1 * table.num_rows:
        remedy = f"give every row {len(names)} cells"
        raise InputError(f"{len(skipped)} rows have another number of cells", file=path, remedy=remedy)
    out: dict[str, np.ndarray] = {}
    text: list[str] = []
    for name, key in zip(names, keys, strict=True):
        values = _numbers(table[key].to_pylist(), style.decimal)
        if values is None:
            text.append(name)
        else:
            out[name] = values
    return out, text


def _numbers(cells: list[str | None], decimal: str) -> np.ndarray | None:
    """Cells as floats; None where more than a few are text."""
    out = np.full(len(cells), np.nan)
    bad = 0
    for i, cell in enumerate(cells):
        cell = (cell or "").strip()
        if decimal == ",":
            cell = cell.replace(",", ".", 1)
        try:
            out[i] = float(cell)
        except ValueError:
            low = cell.lower()
            if low in ("true", "false"):
                out[i] = low == "true"
            elif low not in _EMPTY:
                bad += 1
    if bad > 0.02 * len(cells):
        return _stamps(cells)
    return np.where(np.isfinite(out), out, np.nan)


def _stamps(cells: list[str | None]) -> np.ndarray | None:
    """Written dates and times as seconds since 1970; None where they are not such."""
    try:
        texts = [(c or "").strip().replace(",", ".").rstrip("Z") for c in cells]
        stamps = np.array(texts, dtype="datetime64[ns]")
    except ValueError:
        return None
    return np.where(np.isnat(stamps), np.nan, stamps.astype(np.int64) / 1e9)
