"""Provenance of a result: versions, seeds and hashes of its input files; no time and no place."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Mapping, Sequence
from hashlib import file_digest
from importlib import metadata
from pathlib import Path
from typing import Any

from .errors import InputError
from .text import plain
from .version import VERSION

#: Whose version may change a number.
PACKAGES = ("workbench", "numpy", "scipy", "numba", "drake", "mujoco", "pin", "pyarrow")


def provenance(files: Iterable[str | Path], seeds: Mapping[str, int] | None = None) -> dict[str, Any]:
    """Return the block ``provenance`` of a result's JSON.

    Files go by their names alone, so that the same inputs give the same bytes wherever they lie.

    Args:
        files: all that was read; each counts once.
        seeds: by what they seed.

    Raises:
        InputError: a file cannot be read.
    """
    once = dict.fromkeys(Path(f).resolve() for f in files)
    return {
        "versions": versions(PACKAGES),
        "seeds": dict(seeds or {}),
        "inputs": [{"file": plain(f.name), "sha256": digest(f)} for f in once],
    }


def versions(packages: Sequence[str]) -> dict[str, str]:
    """Return the versions of Python and of those packages that are installed."""
    found = {"python": platform.python_version()}
    for name in packages:
        try:
            found[name] = VERSION if name == "workbench" else metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def digest(file: str | Path) -> str:
    """Return the SHA-256 of a file, hexadecimal.

    Raises:
        InputError: it cannot be read.
    """
    try:
        with Path(file).open("rb") as stream:
            return file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"cannot read: {error.strerror or error}", file=file) from error
