"""Table formats: each reader takes a file and column names and gives arrays in the table's own units."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from workbench.core import InputError
from workbench.core.bounds import bounded, check_fetched

from .can_table import read_can
from .csv_table import read_csv
from .matlab_table import read_matlab
from .parquet_table import read_parquet

Reader = Callable[[Path, Sequence[str]], dict[str, np.ndarray]]

#: File ending -> reader; the longest ending that fits wins.
READERS: dict[str, Reader] = {
    ".csv": read_csv,
    ".csv.gz": read_csv,
    ".parquet": read_parquet,
    ".mat": read_matlab,
    ".log": read_can,
    ".blf": read_can,
    ".asc": read_can,
    ".mf4": read_can,
}

#: What is no table by itself, and becomes one.
_IMPORTED = (".mcap", ".mcap.gz", ".npz", ".npy", ".txt", ".tsv", ".db3")


def read_table(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named columns of a table.

    Args:
        path: the table file; its ending says the format.
        columns: the columns wanted; others are not read.

    Returns:
        column -> float array (N,), all of one length N >= 1; an empty cell is NaN.

    Raises:
        InputError: unknown format, missing or unreadable file, missing column, non-numeric cell,
            columns of different lengths, no rows.
    """
    name = path.name.lower()
    if name.endswith(_IMPORTED):
        remedy = f"run 'workbench import {path.name}': it makes a table of it"
        raise InputError("this is not a table of columns yet", file=path, remedy=remedy)
    endings = [e for e in READERS if name.endswith(e)]
    if not endings:
        remedy = f"convert it to one of {', '.join(READERS)}"
        raise InputError("this table format is unknown", file=path, remedy=remedy)
    if not path.is_file():
        remedy = "check `table` in the recording's TOML; it is relative to that file"
        wrong = "is a folder, not a table" if path.is_dir() else "the table is missing"
        raise InputError(wrong, file=path, remedy=remedy)
    check_fetched(path)
    with bounded(path):
        data = READERS[max(endings, key=len)](path, list(dict.fromkeys(columns)))
    _check_lengths(data, path)
    return data


def _check_lengths(data: dict[str, np.ndarray], path: Path) -> None:
    first, length = next((c, len(a)) for c, a in data.items())
    for column, array in data.items():
        if len(array) != length:
            raise InputError(
                f"has {len(array)} rows where '{first}' has {length}", file=path, column=column,
                remedy="give columns of one length",
            )  # fmt: skip
    if length == 0:
        raise InputError("the table has no rows", file=path, remedy="record again or name another table")
