"""Several recordings, by their files, by patterns, or as they are."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable
from pathlib import Path

from workbench.core import InputError, Recording, Recordings
from workbench.core.files import as_path

from .description import is_model_file
from .read import load_recording

#: A recording, or its TOML file, or a pattern of such files.
Source = Recording | str | Path


def load_recordings(paths: Source | Iterable[Source], *, some: bool = False) -> Recordings:
    """Return the recordings of several TOML files or patterns.

    Args:
        paths: TOML files or patterns (``"data/*.toml"``), or one of them; what a pattern finds is sorted, and
            models that it finds beside recordings are left out. Recordings are returned as they are.
        some: refuse to return none.

    Raises:
        InputError: as `load_recording`, or a pattern that finds nothing, or a table in memory.
    """
    if hasattr(paths, "keys"):  # a data frame or dictionary: its elements are names of columns
        raise InputError(
            f"a recording is expected, not a value of type {type(paths).__name__}",
            remedy="write it to a CSV file, and read that with import_table",
        )
    many = [paths] if isinstance(paths, Recording | str | Path) or not isinstance(paths, Iterable) else paths
    out, loaded = Recordings(), set[Path]()
    for one in many:
        if isinstance(one, Recording):
            out.append(one)
            continue
        files = [f for f in recording_files(as_path(one, "a recording")) if f not in loaded]
        out += map(load_recording, files)
        loaded.update(files)
    if some and not out:
        raise InputError("no recordings were given", remedy="give one or several")
    return out


def recording_files(paths: str | Path | Iterable[str | Path]) -> list[Path]:
    """Return the files that `load_recordings` would read, each once.

    Raises:
        InputError: a pattern that finds nothing.
    """
    paths = [paths] if isinstance(paths, str | Path) else list(paths)
    files: list[Path] = []
    for path in map(str, paths):
        found = sorted(glob.glob(path, recursive=True)) if glob.has_magic(path) else [path]
        recordings = [p for p in found if not is_model_file(Path(p))]
        found = recordings or found  # of models alone the reader says what they are
        if os.path.exists(path):  # False too where no file can have this name
            found = [path]
        if not found:
            raise InputError("no file matches this pattern", file=path, remedy="check the path")
        files += map(Path, found)
    return list(dict.fromkeys(files))
