"""Which model file is meant by a path or a name."""

from __future__ import annotations

from pathlib import Path

from workbench.core import InputError
from workbench.core.paths import models_folder


def find_model(path: str | Path) -> Path:
    """The file meant by `path`: itself, or a shipped model of that name (``leg``, ``models/leg.toml``).

    Raises:
        InputError: neither exists; names the shipped models.
    """
    given = Path(path)
    if given.is_file():
        return given
    shipped = models_folder() / f"{given.stem}.toml"
    if given.suffix in ("", ".toml") and given.parent.name in ("", "models") and shipped.is_file():
        return shipped
    names = ", ".join(sorted(p.stem for p in models_folder().glob("*.toml")))
    raise InputError(
        "no such model file", file=path, remedy=f"give a .toml, .xml or .urdf file, or one of {names}"
    )
