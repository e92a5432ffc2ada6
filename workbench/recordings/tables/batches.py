"""Tables read in pieces, for logs that do not fit into memory."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from workbench.core import InputError
from workbench.core.bounds import opened

from .csv_table import csv_batches
from .parquet_table import parquet_batches

_BLOCK = 1 << 22  # bytes of text
#: Tables that are read piece by piece; of others all rows come at once.
STREAMED = (".parquet", ".csv", ".csv.gz")


def count_rows(path: Path) -> int:
    """Return the number of rows of a table that is read in pieces: lines of a CSV file minus its header."""
    try:
        if path.name.lower().endswith(".parquet"):
            with pq.ParquetFile(path) as file:
                return file.metadata.num_rows
        with opened(path) as file:
            lines, last = 0, b"\n"
            while block := file.read(_BLOCK):
                lines, last = lines + block.count(b"\n"), block[-1:]
            return max(0, lines + (last != b"\n") - 1)
    except (pa.ArrowInvalid, OSError, EOFError, zlib.error) as error:
        raise InputError(
            "is not a readable table", file=path, remedy="check that the file is whole"
        ) from error


def read_batches(path: Path, columns: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
    """Yield the named columns from the first row to the last, some thousand rows at a time.

    Args:
        path: a table that ends in one of `STREAMED`.
        columns: the columns wanted; others are not read.

    Yields:
        column -> float array (K,); what `read_table` reads, in pieces.

    Raises:
        InputError: as `read_table`.
    """
    read = parquet_batches if path.name.lower().endswith(".parquet") else csv_batches
    return read(path, list(dict.fromkeys(columns)))
