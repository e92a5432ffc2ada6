"""Output appears whole or not at all, and nothing is overwritten unasked."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from .errors import InputError


def write_whole(path: str | Path, data: str | bytes, *, force: bool = False) -> Path:
    """Write `data` to `path` by way of a temporary file in the same folder and a rename.

    The folder is made if need be; text is written as UTF-8.

    Returns:
        The path written.

    Raises:
        InputError: the file exists and `force` is not set, or the folder cannot be written.
    """
    target = Path(path)
    check_free(target, force=force)
    raw = data.encode() if isinstance(data, str) else data
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    except OSError as error:
        raise InputError(f"cannot write: {error.strerror}", file=target) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(raw)
            stream.flush()
            os.fsync(stream.fileno())
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, target)
    except OSError as error:
        raise InputError(f"cannot write: {error.strerror}", file=target) from error
    finally:
        Path(name).unlink(missing_ok=True)
    return target


def check_free(path: str | Path, *, force: bool) -> None:
    """Refuse an output that exists already, before any work is done for it.

    Raises:
        InputError: the path exists and `force` is not set, or it is a folder.
    """
    if Path(path).is_dir():
        raise InputError("is a folder, not a file", file=path, remedy="give a file name")
    if Path(path).exists() and not force:
        raise InputError("the file exists", file=path, remedy="choose another name or add --force")
