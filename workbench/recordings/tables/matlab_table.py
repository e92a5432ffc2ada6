"""MATLAB files up to version 7: ``name``, ``struct.field`` and ``name[3]`` for the fourth channel."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from workbench.core import InputError

from .matlab_structure import check_matlab
from .missing import missing_column

_COLUMN = re.compile(r"(?P<path>[^\[\]]+?)\s*(?:\[(?P<index>\d+)\])?")


def read_matlab(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named columns; see `read_table`. Of a 2-D array the longer side is time."""
    roots = {column: column.split(".")[0].split("[")[0].strip() for column in columns}
    check_matlab(path)
    try:
        data = scipy.io.loadmat(path, variable_names=list(roots.values()), struct_as_record=False)
        known = (
            [str(name) for name, _, _ in scipy.io.whosmat(path)] if set(roots.values()) - set(data) else []
        )
    except NotImplementedError as error:
        remedy = "save it again in MATLAB with save(..., '-v7')"
        raise InputError("MATLAB 7.3 files are not read", file=path, remedy=remedy) from error
    except Exception as error:  # scipy raises whatever its parser met
        remedy = "check that the file is whole"
        raise InputError("is not a readable MATLAB file", file=path, remedy=remedy) from error
    for column, root in roots.items():
        if root not in data:
            raise missing_column(column, known, path)
    return {column: _extract(data, column, path) for column in columns}


def _extract(data: dict[str, Any], column: str, path: Path) -> np.ndarray:
    match = _COLUMN.fullmatch(column)
    if match is None:
        remedy = "write name, name[3] or struct.name[3]"
        raise InputError("is not a name of a MATLAB array", file=path, column=column, remedy=remedy)
    root, *fields = match["path"].split(".")
    value: Any = data[root]
    for field in fields:
        value = value.flat[0] if isinstance(value, np.ndarray) and value.size == 1 else value
        known = getattr(value, "_fieldnames", [])
        if field not in known:
            raise missing_column(column, [column.replace(field, k, 1) for k in known], path)
        value = getattr(value, field)
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "biuf" or value.ndim > 2:
        remedy = "name a real array of one or two dimensions"
        raise InputError("does not hold numbers in a row", file=path, column=column, remedy=remedy)
    return _channel(value, None if match["index"] is None else int(match["index"]), column, path)


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
