"""Every kind of file that an engineer may have, opened: what it is says its content, then its name."""

from __future__ import annotations

import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.core import InputError
from workbench.core.bounds import bounded, check_fetched, opened

from ..table import Table
from .arrays import read_matlab_file, read_numpy_file, read_parquet_file
from .can_log import read_can_log
from .json_log import read_json
from .lerobot import is_lerobot, read_lerobot
from .logs import read_bag, read_mcap_file
from .text import read_text
from .torch_file import read_torch_file

#: File ending -> reader; what has another ending is taken for text.
READERS = {
    ".parquet": read_parquet_file,
    ".mat": read_matlab_file,
    ".npy": read_numpy_file,
    ".npz": read_numpy_file,
    ".mcap": read_mcap_file,
    ".blf": read_can_log,
    ".asc": read_can_log,
    ".mf4": read_can_log,
    ".json": read_json,
    ".jsonl": read_json,
    ".ndjson": read_json,
    ".pt": read_torch_file,
    ".pth": read_torch_file,
}

_LARGEST = 1e30
_ARCHIVES = (".zip", ".tar", ".tgz", ".tar.gz", ".7z", ".rar", ".bz2", ".xz", ".zst")
_JSON = (".json", ".jsonl", ".ndjson")
_PICKLES = (".pkl", ".pickle", ".joblib")
_STARTS = b"{", b"[{", b"[["  # of JSON, whatever the file is called


def open_table(path: Path, *, episode: int = 0) -> Table:
    """Return the columns of a file or folder of any known format.

    Args:
        path: a table, a log, a ROS 2 bag or a LeRobot data set.
        episode: which episode of a LeRobot data set.

    Raises:
        InputError: it is missing, of no known kind, damaged, or larger than a table may be.
    """
    if not path.exists():
        raise InputError("there is no such file", file=path, remedy="check the path")
    if path.is_file():
        check_fetched(path)
    with bounded(path):
        return _measurable(_folder(path, episode) if path.is_dir() else _reader(path)(path))


def _measurable(table: Table) -> Table:
    """The same with cells empty that no instrument has written, and of which no square is a number."""
    columns, notes = dict(table.columns), list(table.notes)
    for name, values in table.columns.items():
        wild = np.abs(values) > _LARGEST
        if wild.any():
            columns[name] = np.where(wild, np.nan, values)
            notes.append(
                f"'{name}' has {wild.sum()} cells that are not measurements; they are treated as empty."
            )
    return replace(table, columns=columns, notes=tuple(notes)) if len(notes) > len(table.notes) else table


def _reader(path: Path):
    name = path.name.lower()
    if name.endswith(_ARCHIVES):
        raise InputError("is an archive", file=path, remedy="unpack it and give the table in it")
    if name.endswith(_PICKLES):
        remedy = "save the numbers as .csv, .parquet or .npz"
        raise InputError("is a pickle, and reading it could run code", file=path, remedy=remedy)
    if name.endswith((".xlsx", ".xls", ".ods")):
        raise InputError("is a spreadsheet", file=path, remedy="save it as CSV")
    if name.endswith((".db3", ".yaml")) and (path.parent / "metadata.yaml").is_file():
        raise InputError("is part of a ROS 2 bag", file=path, remedy=f"give the folder: {path.parent}")
    if name.endswith((".h5", ".hdf5")):
        raise InputError("is an HDF5 file", file=path, remedy="save the arrays as .npz, .mat (-v7) or .csv")
    if name.endswith(".log"):
        with path.open("rb") as file:
            if file.read(1) == b"(":
                return read_can_log
    suffix = Path(name.removesuffix(".gz")).suffix
    if suffix in READERS and (suffix in _JSON or not name.endswith(".gz")):
        return READERS[suffix]
    return read_json if _is_json(path) else read_text


def _is_json(path: Path) -> bool:
    try:
        with opened(path) as file:
            start = b"".join(file.read(200).removeprefix(b"\xef\xbb\xbf").split())
    except (OSError, EOFError, zlib.error):
        return False  # the reader says so
    return start.startswith(_STARTS)


def _folder(path: Path, episode: int) -> Table:
    if is_lerobot(path):
        return read_lerobot(path, episode)
    if (path / "metadata.yaml").is_file() or list(path.glob("*.mcap")):
        return read_bag(path)
    raise InputError(
        "is a folder, and neither a ROS 2 bag (metadata.yaml) nor a LeRobot data set (meta/info.json)",
        file=path, remedy="give one file",
    )  # fmt: skip
