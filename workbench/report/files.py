"""Output that appears whole or not at all, and never over somebody's file unless told to."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from workbench.core import InputError


def write_whole(content: bytes | str, path: str | Path, *, force: bool = False) -> Path:
    """Write `content` to `path` in one go: a temporary file beside it, then a rename.

    Args:
        content: text (written as UTF-8) or bytes.
        path: where to.
        force: overwrite a file that is there already.

    Returns:
        The path written.

    Raises:
        InputError: the file exists and `force` is false, or its folder cannot be written to.
    """
    path = check_target(path, force=force)
    data = content.encode("utf-8") if isinstance(content, str) else content
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"cannot write: {error.strerror or error}", file=path) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
    return path


def check_target(path: str | Path, *, force: bool = False) -> Path:
    """The path, if it may be written to: worth asking before an hour of computing."""
    path = Path(path)
    if path.is_dir():
        raise InputError("is a folder, not a file", file=path)
    if not path.parent.is_dir():
        raise InputError("its folder does not exist", file=path, remedy="make the folder first")
    if path.exists() and not force:
        raise InputError("exists already", file=path, remedy="choose another name or pass --force")
    return path


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
