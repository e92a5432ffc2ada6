"""The files that a recording is read from."""

from __future__ import annotations

from pathlib import Path

from .description import read_description
from .tables import READERS
from .tables.can_table import dbc_of, read_can


def source_files(path: str | Path) -> list[Path]:
    """Return a recording's TOML file, its table, and the DBC file if the table is a log of a bus.

    Raises:
        InputError: the TOML file cannot be read.
    """
    file = Path(path)
    table = file.parent / read_description(file).table
    log = READERS.get(table.suffix.lower()) is read_can
    dbc = dbc_of(table) if log else None
    return [file, table, *([dbc] if dbc else [])]
