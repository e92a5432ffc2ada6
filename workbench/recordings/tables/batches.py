"""A table piece by piece, for logs that are longer than memory."""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq

from workbench.core import InputError

from .csv_table import read_cells, separated_columns
from .floats import floats
from .missing import missing_column
from .parquet_table import as_floats

_BATCH = 16_384  # rows
_BLOCK = 1 << 22  # bytes of text
#: Tables that are read piece by piece; of others all rows come at once.
STREAMED = (".parquet", ".csv", ".csv.gz")


def count_rows(path: Path) -> int:
    """Rows of a table that is read piece by piece, lines of a CSV file without its first."""
    try:
        if path.name.lower().endswith(".parquet"):
            with pq.ParquetFile(path) as file:
                return file.metadata.num_rows
        opener = gzip.open if path.name.lower().endswith(".gz") else io.open
        with opener(path, "rb") as file:
            lines, last = 0, b"\n"
            while block := file.read(_BLOCK):
                lines, last = lines + block.count(b"\n"), block[-1:]
            return max(0, lines + (last != b"\n") - 1)
    except (pa.ArrowInvalid, OSError, EOFError, zlib.error) as error:
        raise InputError(
            "is not a readable table", file=path, remedy="check that the file is whole"
        ) from error


def read_batches(path: Path, columns: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
    """The named columns from the first row to the last, some thousand rows at a time.

    Args:
        path: a table that ends in one of `STREAMED`.
        columns: the columns wanted; others are not read.

    Yields:
        column -> float array (K,); what `read_table` reads, in pieces.

    Raises:
        InputError: as `read_table`.
    """
    parquet = path.name.lower().endswith(".parquet")
    return (_parquet if parquet else _csv)(path, list(dict.fromkeys(columns)))


def _parquet(path: Path, columns: list[str]) -> Iterator[dict[str, np.ndarray]]:
    try:
        # pages as they come: a writer may have put the whole log into one group of rows
        with pq.ParquetFile(path, pre_buffer=False, buffer_size=1 << 16) as file:
            names = file.schema_arrow.names
            for column in columns:
                if column not in names:
                    raise missing_column(column, names, path)
            for batch in file.iter_batches(_BATCH, columns=columns, use_threads=False):
                yield {c: as_floats(batch.column(batch.schema.get_field_index(c)), path, c) for c in columns}
    except (pa.ArrowInvalid, OSError) as error:
        remedy = "check that the file is whole"
        raise InputError("is not a readable parquet file", file=path, remedy=remedy) from error


def _csv(path: Path, columns: list[str]) -> Iterator[dict[str, np.ndarray]]:
    width, separator, places = separated_columns(path, columns)
    done = 0
    try:
        for batch in _text(path, width, separator, list(places.values()), pa.float64()):
            yield {c: floats(batch.column(p)) for c, p in places.items()}
            done += len(batch)
        return
    except (pa.ArrowInvalid, OSError, EOFError, zlib.error):
        pass  # a cell that is no number: from there on the slow way, which says which
    row = 0
    try:
        for batch in _text(path, width, separator, list(places.values()), pa.string()):
            skip = min(len(batch), max(0, done - row))
            row += skip
            cells = {c: batch.column(p).to_pylist()[skip:] for c, p in places.items()}
            if len(batch) > skip:
                yield {c: read_cells(texts, path, c, row + 1) for c, texts in cells.items()}
            row += len(batch) - skip
    except (pa.ArrowInvalid, OSError, EOFError, zlib.error) as error:
        remedy = f"give every row {width} cells, and check that the file is whole"
        raise InputError(f"cannot be read: {error}", file=path, remedy=remedy) from error


def _text(
    path: Path, width: int, separator: str, places: list[str], kind: pa.DataType
) -> Iterator[pa.RecordBatch]:
    reader = pacsv.open_csv(
        path,
        read_options=pacsv.ReadOptions(
            column_names=[f"c{i}" for i in range(width)], skip_rows=1, block_size=_BLOCK, use_threads=False
        ),
        parse_options=pacsv.ParseOptions(delimiter=separator),
        convert_options=pacsv.ConvertOptions(
            include_columns=places, column_types=dict.fromkeys(places, kind), strings_can_be_null=False
        ),
    )
    with reader:
        yield from reader
