"""Parquet: only the columns asked for are read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from workbench.core import InputError

from .floats import floats
from .missing import missing_column


def read_parquet(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named columns; see `read_table`. Null cells are NaN."""
    try:
        with pq.ParquetFile(path) as file:
            names = file.schema_arrow.names
            for column in columns:
                if column not in names:
                    raise missing_column(column, names, path)
            table = file.read(columns=list(columns))
    except (pa.ArrowException, OSError, ValueError) as error:
        remedy = "check that the file is whole"
        raise InputError("is not a readable parquet file", file=path, remedy=remedy) from error
    return {column: as_floats(table[column], path, column) for column in columns}


def as_floats(array: pa.ChunkedArray | pa.Array, path: Path, column: str) -> np.ndarray:
    """Numbers of a column; null is NaN.

    Raises:
        InputError: it holds something else.
    """
    numeric = (pa.types.is_integer, pa.types.is_floating, pa.types.is_boolean, pa.types.is_decimal)
    if not any(is_kind(array.type) for is_kind in numeric):
        remedy = "store numbers (a time stamp as seconds)"
        raise InputError(f"holds {array.type}, not numbers", file=path, column=column, remedy=remedy)
    return floats(array)
