"""CSV, plain or gzipped: header in the first line; comma, semicolon or tab between cells."""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv

from workbench.core import InputError
from workbench.core.bounds import opened

from .floats import floats
from .missing import missing_column

_BLOCK = 1 << 22  # bytes of text that are parsed at once
_BOOLEANS = {"true": 1.0, "false": 0.0}
_EMPTY = ("", "nan", "null", "na", "n/a", "none", "#n/a")


def read_csv(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named columns; see `read_table`. Byte order mark, CRLF and padded names are fine."""
    parts = list(csv_batches(path, columns))
    return {c: np.concatenate([part[c] for part in parts]) if parts else np.empty(0) for c in columns}


def csv_batches(path: Path, columns: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
    """Yield the same in pieces, from the first row to the last."""
    width, separator, places = separated_columns(path, columns)
    done = 0
    try:
        for batch in _parsed(path, width, separator, places, pa.float64()):
            yield {c: floats(batch.column(p)) for c, p in places.items()}
            done += len(batch)
        return
    except (pa.ArrowInvalid, OSError, EOFError, zlib.error):
        pass  # a cell that is no number: from there on the slow way, which knows true and false
    row = 0
    try:
        for batch in _parsed(path, width, separator, places, pa.string()):
            skip = min(len(batch), max(0, done - row))
            row += skip
            cells = {c: batch.column(p).to_pylist()[skip:] for c, p in places.items()}
            if len(batch) > skip:
                yield {c: _cells(texts, path, c, row + 1) for c, texts in cells.items()}
            row += len(batch) - skip
    except (pa.ArrowInvalid, OSError, EOFError, zlib.error) as error:
        remedy = f"give every row {width} cells, and check that the file is whole"
        raise InputError(f"cannot be read: {error}", file=path, remedy=remedy) from error


def separated_columns(path: Path, columns: Sequence[str]) -> tuple[int, str, dict[str, str]]:
    """Return the number of columns, their separator, and the positions of the wanted columns.

    Raises:
        InputError: no readable header, or a column is missing.
    """
    names, separator = _header(path)
    for column in columns:
        if column not in names:
            raise missing_column(column, names, path)
    # columns are told apart by place: other columns may share a name without harm
    return len(names), separator, {column: f"c{names.index(column)}" for column in columns}


def csv_bytes(columns: Mapping[str, np.ndarray], *, pack: bool = True) -> bytes:
    """Return the table of these columns, gzipped if `pack`; the same columns give the same bytes."""
    out = io.BytesIO()
    options = pacsv.WriteOptions(quoting_style="needed", quoting_header="none")
    table = pa.table({name: np.ascontiguousarray(values) for name, values in columns.items()})
    pacsv.write_csv(table, out, options)
    return gzip.compress(out.getvalue(), compresslevel=6, mtime=0) if pack else out.getvalue()


def _cells(texts: Sequence[str], path: Path, column: str, first: int) -> np.ndarray:
    """Return the numbers (K,) of a column's cells; the first cell is in row `first`."""
    return np.array([_cell(text, path, column, k) for k, text in enumerate(texts, first)], float)


def _header(path: Path) -> tuple[list[str], str]:
    try:
        with opened(path) as file:
            line = file.readline().decode("utf-8-sig")
    except (OSError, EOFError, zlib.error, UnicodeDecodeError) as error:
        remedy = "check that the file is whole and of the format its name says"
        raise InputError("is not a readable CSV file", file=path, remedy=remedy) from error
    separator = max(",;\t", key=line.count)
    names = [name.strip().strip('"').strip() for name in line.strip("\r\n").split(separator)]
    if names == [""]:
        raise InputError("the table is empty", file=path, remedy="record again or name another table")
    return names, separator


def _parsed(
    path: Path, width: int, separator: str, places: dict[str, str], kind: pa.DataType
) -> Iterator[pa.RecordBatch]:
    reader = pacsv.open_csv(
        path,
        read_options=pacsv.ReadOptions(
            column_names=[f"c{i}" for i in range(width)], skip_rows=1, block_size=_BLOCK, use_threads=False
        ),
        parse_options=pacsv.ParseOptions(delimiter=separator),
        convert_options=pacsv.ConvertOptions(
            include_columns=list(places.values()),
            column_types=dict.fromkeys(places.values(), kind),
            strings_can_be_null=False,
        ),
    )
    with reader:
        yield from reader


def _cell(text: str, path: Path, column: str, row: int) -> float:
    text = text.strip().lower()
    if text in _EMPTY:
        return np.nan
    try:
        return _BOOLEANS[text] if text in _BOOLEANS else float(text)
    except ValueError:
        problem, remedy = f"'{text}' is not a number", "write numbers with a decimal point"
        raise InputError(problem, file=path, column=column, row=row, remedy=remedy) from None
