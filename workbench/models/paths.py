"""The model file meant by a path or a name."""

from __future__ import annotations

from pathlib import Path

from workbench.core import InputError
from workbench.core.paths import models_folder

from .packaged import is_packaged, packaged_robot


def find_model(path: str | Path) -> Path:
    """Return the file meant by `path`: itself, a shipped model (``leg``), or a packaged robot.

    Raises:
        InputError: there is none; names the shipped models, or what the package of robots lacks.
    """
    given = Path(path)
    if given.is_file():
        return given
    shipped = _shipped(given)
    if shipped is not None:
        return shipped
    packaged = packaged_robot(str(path))
    if packaged is not None:
        return packaged
    names = ", ".join(sorted(p.stem for p in models_folder().glob("*.toml")))
    raise InputError(
        "no such model file", file=path, remedy=f"give a .toml, .xml or .urdf file, or one of {names}"
    )


def is_named_model(name: str) -> bool:
    """Whether a text is a shipped model's name or a packaged robot's, and nothing else here is called so."""
    given = Path(name)
    return not given.exists() and (_shipped(given) is not None or is_packaged(name))


def _shipped(given: Path) -> Path | None:
    """The shipped model of a name; None where there is none."""
    file = models_folder() / f"{given.stem}.toml"
    named = given.suffix in ("", ".toml") and given.parent.name in ("", "models")
    return file if named and file.is_file() else None
