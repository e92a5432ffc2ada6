"""MATLAB files up to version 7: ``name``, ``struct.field`` and ``name[3]`` for the fourth channel."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from workbench.core import InputError

from .apart import matlab_arrays
from .missing import missing_column

_COLUMN = re.compile(r"(?P<path>[^\[\]]+?)\s*(?:\[(?P<index>\d+)\])?")


def read_matlab(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named columns; see `read_table`. The longer side of a 2-D array is time."""
    data = matlab_arrays(path, [re.split(r"[.\[]", column)[0].strip() for column in columns])
    return {column: _extract(data, column, path) for column in columns}


def _extract(data: Mapping[str, np.ndarray | None], column: str, path: Path) -> np.ndarray:
    match = _COLUMN.fullmatch(column)
    if match is None:
        remedy = "write name, name[3] or struct.name[3]"
        raise InputError("is not a name of a MATLAB array", file=path, column=column, remedy=remedy)
    name = match["path"]
    if name not in data and not any(known.startswith(f"{name}.") for known in data):
        raise missing_column(column, data, path)
    array = data.get(name)
    if array is None:
        remedy = "name a real array of one or two dimensions"
        raise InputError("does not hold numbers in a row", file=path, column=column, remedy=remedy)
    return _channel(array, None if match["index"] is None else int(match["index"]), column, path)


def _channel(array: np.ndarray, index: int | None, column: str, path: Path) -> np.ndarray:
    by_row = np.atleast_2d(array)
    by_row = by_row.T if by_row.shape[0] < by_row.shape[1] else by_row
    channels = by_row.shape[1]
    if index is None and channels > 1:
        remedy = f"pick one, as in {column}[0]"
        raise InputError(f"holds {channels} channels", file=path, column=column, remedy=remedy)
    if (index or 0) >= channels:
        remedy = f"indices run from 0 to {channels - 1}"
        raise InputError(f"has no channel {index}", file=path, column=column, remedy=remedy)
    return np.array(by_row[:, index or 0], dtype=float)
