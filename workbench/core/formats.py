"""Format numbers of files; a file of a future format is refused."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .errors import InputError


def check_format(content: Any, known: int, file: str | Path) -> None:
    """Refuse a file of a newer version, before its unknown keys are reported as mistakes.

    A number that is missing or below is left to the file's own grammar: old files keep loading.

    Args:
        content: the whole file, parsed.
        known: the newest format that this version reads.
        file: where it stands.

    Raises:
        InputError: its ``format`` is above `known`.
    """
    found = content.get("format") if isinstance(content, Mapping) else None
    if isinstance(found, int) and found > known:
        raise InputError(
            f"format {found} was written by a newer workbench; this one reads {known}",
            file=file, column="format", remedy="update workbench",
        )  # fmt: skip
