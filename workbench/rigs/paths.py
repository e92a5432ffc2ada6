"""Where the closed chains are: beside the package in a clone, inside it in an installed wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent
_ROOTS = (_PACKAGE / "_models", _PACKAGE.parent / "models")


def closed_chain_file(name: str) -> Path:
    """The SDF file of a shipped closed chain, e.g. ``"leg"``.

    Raises:
        FileNotFoundError: no such chain is shipped; names the folders searched.
    """
    candidates = [root / "closed_chain" / f"{name}.sdf" for root in _ROOTS]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise FileNotFoundError(f"closed chain '{name}' not found as {' or '.join(map(str, candidates))}")
