"""The folder of the shipped models: beside the package in a clone, inside it in an installed wheel."""

from __future__ import annotations

from pathlib import Path

from .errors import InputError

_PACKAGE = Path(__file__).resolve().parent.parent
_ROOTS = (_PACKAGE / "_models", _PACKAGE.parent / "models")


def models_folder(roots: tuple[Path, ...] = _ROOTS) -> Path:
    """Return the folder of the shipped models: TOML files, with ``serial`` and ``closed_chain`` in it.

    Raises:
        InputError: the installation has none; names the folders searched.
    """
    for root in roots:
        if root.is_dir():
            return root
    searched = " or ".join(map(str, roots))
    raise InputError("the shipped models are missing", file=searched, remedy="install workbench again")


def closed_chain_file(name: str) -> Path:
    """Return the SDF file of a shipped closed chain, e.g. ``"leg"``.

    Raises:
        InputError: no such chain is shipped; names those that are.
    """
    folder = models_folder() / "closed_chain"
    file = folder / f"{name}.sdf"
    if file.is_file():
        return file
    known = ", ".join(sorted(p.stem for p in folder.glob("*.sdf")))
    raise InputError("no such closed chain is shipped", file=file, remedy=f"choose one of {known}")
