"""Parquet, MATLAB and NumPy files: every array of numbers in them becomes columns; nothing in them is run."""

from __future__ import annotations

import tokenize
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from workbench.core import InputError
from workbench.core.bounds import MOST_BYTES, check_cells, too_large
from workbench.recordings.tables.apart import matlab_arrays

from ..table import Table
from .joint_names import of_list

#: What the reader of a header raises, which evaluates it as a literal.
_HEADERS = SyntaxError, tokenize.TokenError, TypeError, KeyError
_WHOLE = "check that the file is whole"


def read_parquet_file(path: Path) -> Table:
    """Return the columns of a Parquet file; lists of fixed length become ``name[0]``, ``name[1]``..."""
    try:
        with pq.ParquetFile(path) as file:
            check_cells(file.metadata.num_rows * file.metadata.num_columns, path)
            check_unpacked(file.metadata, path)
            table = file.read()
    except (pa.ArrowException, OSError, ValueError) as error:
        raise InputError("is not a readable Parquet file", file=path, remedy=_WHOLE) from error
    columns, plain = parquet_columns(table, path)
    if not columns:
        raise InputError("holds no numbers", file=path, remedy="name another file")
    return Table(path, columns, plain=plain)


def parquet_columns(table: pa.Table, path: Path) -> tuple[dict[str, np.ndarray], bool]:
    """Return the numbers of an Arrow table, and whether each stood in a column of its own."""
    out: dict[str, np.ndarray] = {}
    plain = len(set(table.column_names)) == len(table.column_names)
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind) or pa.types.is_large_list(kind):
            plain = False
            out |= _list_columns(name, column, path)
        elif pa.types.is_timestamp(kind):
            plain = False
            out[name] = column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy() / 1e9
        elif pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind):
            out[name] = np.array(column.to_numpy(), dtype=float)
    return out, plain


def _list_columns(name: str, column: pa.ChunkedArray, path: Path) -> dict[str, np.ndarray]:
    rows = column.to_pylist()
    widths = {len(row) for row in rows if row is not None}
    if len(widths) != 1 or not (width := widths.pop()) or width > 256:
        return {}
    check_cells(width * len(rows), path)
    try:
        array = np.array([row if row is not None else [np.nan] * width for row in rows], dtype=float)
    except (TypeError, ValueError):
        return {}  # of text, or of lists
    return {f"{name}[{i}]": array[:, i] for i in range(width)} if array.ndim == 2 else {}


def check_unpacked(metadata: Any, path: Path) -> None:
    """Raise InputError if a Parquet file is larger than a table may be once it is unpacked."""
    size = sum(metadata.row_group(i).total_byte_size for i in range(metadata.num_row_groups))
    if size > MOST_BYTES:
        raise too_large(path)


def read_matlab_file(path: Path) -> Table:
    """Return the arrays of a MATLAB file up to version 7, by the names that the recording reader takes."""
    arrays = {name: array for name, array in matlab_arrays(path).items() if array is not None}
    return stacked(path, arrays, plain=True)


def stacked(
    path: Path,
    arrays: dict[str, np.ndarray],
    plain: bool,
    left: Sequence[str] = (),
    texts: Mapping[str, Sequence[str]] | None = None,
) -> Table:
    """Return the arrays of the commonest length as columns, with ``[i]`` where an array has several.

    Args:
        path: of the file.
        arrays: of one or two dimensions, by name.
        plain: as of a `Table`.
        left: what else is in the file.
        texts: lists of text in it, which may name the joints.

    Raises:
        InputError: none is as long as a log.
    """
    by_row = {
        n: (a.T if a.shape[0] < a.shape[1] else a)
        for n, a in ((n, np.atleast_2d(a)) for n, a in arrays.items())
    }
    tall = {n: a for n, a in by_row.items() if a.shape[0] >= 8 and a.shape[1] <= 256}
    if not tall:
        raise InputError("holds no arrays with eight rows or more", file=path, remedy="name another file")
    lengths = [len(a) for a in tall.values()]
    length = max(set(lengths), key=lambda n: (lengths.count(n), n))
    columns: dict[str, np.ndarray] = {}
    for name, array in tall.items():
        if len(array) != length:
            continue
        for i in range(array.shape[1]):
            columns[f"{name}[{i}]" if array.shape[1] > 1 else name] = np.array(array[:, i], dtype=float)
    if not columns:
        raise InputError("holds no numbers", file=path, remedy="name another file")
    check_cells(length * len(columns), path)
    other = [name for name, array in by_row.items() if name not in tall or len(array) != length]
    notes = tuple(
        f"'{name}' has a different length than the other columns and is left out." for name in other
    )
    joints = of_list(columns, texts or {})
    if left := [name for name in left if not joints or name not in (texts or {})]:
        notes = (*notes, f"Left out, because they are not arrays of numbers: {', '.join(left)}.")
    return Table(path, columns, plain=plain, notes=notes, joints=joints)


def read_numpy_file(path: Path) -> Table:
    """Return the arrays of a .npy or .npz file; one with objects in it is refused, not unpickled."""
    left: list[str] = []
    texts: dict[str, list[str]] = {}
    try:
        if path.suffix.lower() == ".npy":
            with path.open("rb") as file:
                arrays = dict(_fields("column", _array(file, path)))
        else:
            with zipfile.ZipFile(path) as archive:
                if sum(entry.file_size for entry in archive.infolist()) > MOST_BYTES:
                    raise too_large(path)
                arrays = {}
                for entry in archive.infolist():
                    if entry.filename.endswith(".npy"):
                        with archive.open(entry) as file:
                            array = _array(file, path)
                        found = dict(_fields(entry.filename[:-4], array))
                        arrays |= found
                        if array is not None and array.dtype.kind == "U" and array.ndim == 1:
                            texts[entry.filename[:-4]] = array.tolist()
                        left += [] if found else [entry.filename[:-4]]
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error, RuntimeError, *_HEADERS) as error:
        raise InputError("is not a readable NumPy file", file=path, remedy=_WHOLE) from error
    return stacked(path, arrays, plain=False, left=left, texts=texts)


def _fields(name: str, array: np.ndarray | None) -> Iterator[tuple[str, np.ndarray]]:
    if array is None:
        return
    if array.dtype.names:
        for field in array.dtype.names:
            if array.dtype[field].kind in "biuf" and array[field].ndim <= 2:
                yield field, array[field]
    elif array.dtype.kind in "biuf" and array.ndim in (1, 2):
        yield name, array


def _array(file: IO[bytes], path: Path) -> np.ndarray | None:
    """One array, its header checked before its numbers are read; None where it holds other things."""
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, fortran, kind = read(file)
    if kind.hasobject:
        raise InputError(
            "holds Python objects, and reading those could run code", file=path,
            remedy="save plain arrays of numbers",
        )  # fmt: skip
    count = int(np.prod([float(n) for n in shape])) if shape else 1
    check_cells(count * max(1, len(kind.names or ())), path)
    if kind.itemsize * count > MOST_BYTES:
        raise too_large(path)
    if kind.kind not in "biufVU":
        return None
    raw = file.read(kind.itemsize * count)
    flat = np.frombuffer(raw, dtype=kind, count=count)
    return flat.reshape(shape, order="F" if fortran else "C")
