"""Where the shipped models are: beside the package in a clone, inside it in an installed wheel."""

from __future__ import annotations

from pathlib import Path

from workbench.core import InputError

_PACKAGE = Path(__file__).resolve().parent.parent
_ROOTS = (_PACKAGE / "_models", _PACKAGE.parent / "models")


def models_folder() -> Path:
    """Folder of the shipped models."""
    return next(root for root in _ROOTS if root.is_dir())


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
    raise InputError("no such model file", file=path, remedy=f"give a .toml or .xml file, or one of {names}")
