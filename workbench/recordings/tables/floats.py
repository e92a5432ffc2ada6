"""Columns as floats, without slow imports."""

from __future__ import annotations

import numpy as np
import pyarrow as pa


def floats(column: pa.ChunkedArray | pa.Array) -> np.ndarray:
    """Return the numbers (N,) of a column as a copy; null is NaN."""
    numbers = pa.types.is_integer(column.type) or pa.types.is_floating(column.type)
    if not numbers or column.null_count or not len(column):
        return np.array(column.to_numpy(zero_copy_only=False), dtype=float)
    # arrow's own conversion loads pandas first, wherever that is installed
    chunks = column.chunks if isinstance(column, pa.ChunkedArray) else [column]
    return np.concatenate([np.from_dlpack(chunk) for chunk in chunks], dtype=float)
