"""Text tables of any kind: separator, decimal mark, encoding, preamble and unit row are found, not asked."""

from __future__ import annotations

import io
import re
import zlib
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv

from workbench.core import InputError
from workbench.core.bounds import check_cells, opened, read_bounded

from ..table import Table
from .joint_names import named_by_text
from .text_style import EMPTY, LOOK, Style, cells_of, find_style
from .written_time import stamps


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
    lines = text.split("\n", LOOK + 1)[: LOOK + 1]
    style = find_style(lines, encoding, path)
    names = _names(lines, style)
    body = "\n".join(text.split("\n")[style.first :]).strip("\n") + "\n"
    if style.separator == " ":
        body = re.sub(r"[ \t]+", " ", re.sub(r"(?m)^[ \t]+|[ \t]+$", "", body))
    check_cells(len(names) * body.count("\n"), path)
    columns, texts, exact, notes = _columns(body, names, style, path)
    heads = cells_of(lines[style.header], style.separator) if style.header is not None else []
    plain = (
        exact
        and style.header == 0
        and style.first == 1
        and style.decimal == "."
        and style.separator in ",;\t"
        and encoding == "utf-8-sig"
        and heads == names
        and path.name.lower().endswith((".csv", ".csv.gz"))
    )
    for i, (head, name) in enumerate(zip(heads, names, strict=False)):
        if head and head in names[:i] and name != head:
            notes.append(
                f"The name '{head}' stands more than once in the header; column {i + 1} is called '{name}'."
            )
    if style.decimal == ",":
        notes.append("Numbers have a decimal comma.")
    if encoding not in ("utf-8-sig",):
        notes.append(f"The text is {encoding.upper()}.")
    units = {
        n: u for n, u in zip(names, style.units, strict=False) if u not in ("", "-", "1") and n in columns
    }
    return named_by_text(Table(path, columns, units, plain, None, tuple(notes)), names, texts)


def _raw(path: Path) -> bytes:
    try:
        with opened(path) as file:
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
            "is neither a text table nor another format that is known", file=path,
            remedy="give .csv, .parquet, .mat, .npz, .mcap, a ROS 2 bag, a LeRobot data set or a CAN log",
        )  # fmt: skip
    try:
        raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _names(lines: list[str], style: Style) -> list[str]:
    width = len(cells_of(lines[style.first], style.separator))
    if style.header is None:
        return [f"column_{i + 1}" for i in range(width)]
    cells = cells_of(lines[style.header].lstrip("\ufeff#%/ \t"), style.separator)
    cells = cells[-width:] if style.separator == " " else cells[:width]
    cells += [f"column_{i + 1}" for i in range(len(cells), width)]
    out: list[str] = []
    for i, name in enumerate(cells):
        name = name or f"column_{i + 1}"
        out.append(name if name not in out else f"{name}_{i + 1}")
    return out


def _columns(
    body: str, names: list[str], style: Style, path: Path
) -> tuple[dict[str, np.ndarray], dict[str, list[str]], bool, list[str]]:
    """Numbers by name, text by name, whether all cells of numbers are such, and what was left out."""
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
        raise InputError(f"{len(skipped)} rows have a different number of cells", file=path, remedy=remedy)
    notes = [f"{len(skipped)} rows with another number of cells are left out."] if skipped else []
    out: dict[str, np.ndarray] = {}
    text: dict[str, list[str]] = {}
    exact = True
    for name, key in zip(names, keys, strict=True):
        cells = table[key].to_pylist()
        values, whole = _numbers(cells, style.decimal)
        exact &= whole or values is None
        if values is None:
            text[name] = [(cell or "").strip().strip('"') for cell in cells]
        else:
            out[name] = values
    if not out:
        raise InputError("has no column of numbers", file=path, remedy="give one row per sample")
    return out, text, exact, notes


def _numbers(cells: list[str | None], decimal: str) -> tuple[np.ndarray | None, bool]:
    """Cells as floats, None where more than a few are text; and whether every cell is one or empty."""
    out = np.full(len(cells), np.nan)
    bad, exact = 0, True
    for i, cell in enumerate(cells):
        cell = (cell or "").strip()
        if decimal == ",":
            cell = cell.replace(",", ".", 1)
        try:
            out[i] = float(cell)
            exact &= bool(np.isfinite(out[i])) or cell.lower() == "nan"
        except ValueError:
            low = cell.lower()
            if low in ("true", "false"):
                out[i] = low == "true"
            elif low not in EMPTY:
                bad += 1
            exact &= low in EMPTY and low != "-"
    if bad > 0.02 * len(cells):
        return stamps(cells), False
    return np.where(np.isfinite(out), out, np.nan), exact
