"""Optional packages: a command that needs a missing one says so in one line."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from .errors import InputError


def need(module: str, what: str, package: str, install: str, file: str | Path | None = None) -> None:
    """Refuse work that needs a missing package, before any of it is done.

    Args:
        module: what is imported.
        what: needs it.
        package: its name on an index.
        install: what `pip install` is given.
        file: that was asked for.

    Raises:
        InputError: the package is missing.
    """
    try:
        import_module(module)
    except ImportError as error:
        raise InputError(
            f"{what} needs the package {package}", file=file, remedy=f"install it with: pip install {install}"
        ) from error
