"""Parquet: only the columns asked for are read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from workbench.core import InputError

from .floats import floats
from .missing import missing_column

_BATCH = 16_384  # rows


def read_parquet(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named columns; see `read_table`. Null cells are NaN."""
    parts = list(parquet_batches(path, columns))
    return {c: np.concatenate([part[c] for part in parts]) if parts else np.empty(0) for c in columns}


def parquet_batches(path: Path, columns: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
    """Yield the same in pieces, from the first row to the last."""
    try:
        # pages as they come: a writer may have put the whole log into one group of rows
        with pq.ParquetFile(path, pre_buffer=False, buffer_size=1 << 16) as file:
            names = file.schema_arrow.names
            for column in columns:
                if column not in names:
                    raise missing_column(column, names, path)
            for batch in file.iter_batches(_BATCH, columns=list(columns), use_threads=False):
                yield {c: as_floats(batch.column(batch.schema.get_field_index(c)), path, c) for c in columns}
    except (pa.ArrowException, OSError, ValueError) as error:
        remedy = "check that the file is whole"
        raise InputError("is not a readable parquet file", file=path, remedy=remedy) from error


def as_floats(array: pa.ChunkedArray | pa.Array, path: Path, column: str) -> np.ndarray:
    """Return the numbers of a column; null is NaN.

    Raises:
        InputError: it holds something else.
    """
    numeric = (pa.types.is_integer, pa.types.is_floating, pa.types.is_boolean, pa.types.is_decimal)
    if not any(is_kind(array.type) for is_kind in numeric):
        remedy = "store numbers (a time stamp as seconds)"
        raise InputError(f"holds {array.type}, not numbers", file=path, column=column, remedy=remedy)
    return floats(array)
