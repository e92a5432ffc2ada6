"""A file that is named in the browser: a plain name, in the folder of the bench, not overwriting others."""

from __future__ import annotations

from pathlib import Path

from workbench.core import InputError
from workbench.core.files import check_free
from workbench.report.numbers import plain


def new_file(folder: Path, name: str, ending: str, *, force: bool) -> Path:
    """Return the path of a new file.

    Args:
        folder: where it goes.
        name: as it was typed, with or without the ending.
        ending: as ``.toml``.
        force: whether it may be there already.

    Raises:
        InputError: not a plain file name, or the file exists and `force` is not set.
    """
    name = name.strip()
    if not name or name[0] == "." or Path(name).name != name or "\\" in name or plain(name) != name:
        remedy = f"e.g. better{ending}, without a folder"
        raise InputError(f"'{plain(name)}' is not a plain file name", remedy=remedy)
    target = folder / (name if name.endswith(ending) else name + ending)
    check_free(target, force=force)
    return target
