"""Files that belong together are renamed into place together, even if the process is killed meanwhile.

They lie ready in a hidden folder. One rename of that folder decides that they are to be placed; whoever reads
or writes there next places what a killed process has left. A lock tells it from one that is still at work.
By hand: no file system renames several files at once, and a data base is none that an engineer opens.
"""

from __future__ import annotations

import errno
import fcntl
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from .errors import InputError

#: Hidden folder of files that are decided on and not yet all in their places; one in a folder.
READY = ".unfinished.part"
_NAMES = "names.json"
_TAKEN = errno.ENOTEMPTY, errno.EEXIST  # whoever was there may have gone since: only the error tells


@dataclass
class Stage:
    """Files called ``0``, ``1``, ... in a hidden folder, which wait for their `names` in `folder`.

    `made`: folders that were made for them, the innermost first.
    """

    folder: Path
    hidden: Path | None = None
    names: list[str] = field(default_factory=list)
    made: list[Path] = field(default_factory=list)

    def add(self, files: Mapping[str, str | bytes]) -> None:
        """Write files here, which are on the disk when this returns; if one fails, none of them is kept.

        Raises:
            OSError: the folder cannot be written.
        """
        if self.hidden is None:
            self.made = [p for p in (self.folder, *self.folder.parents) if not p.exists()]
            self.folder.mkdir(parents=True, exist_ok=True)
            finish(self.folder)
            prefix = f".{next(iter(files))[:100]}."
            self.hidden = Path(tempfile.mkdtemp(dir=self.folder, prefix=prefix, suffix=".part"))
        for k, data in enumerate(files.values(), len(self.names)):
            with (self.hidden / str(k)).open("wb") as stream:
                stream.write(data.encode() if isinstance(data, str) else data)
                stream.flush()
                os.fsync(stream.fileno())
        self.names += files

    def place(self) -> None:
        """Move all files to their places; errors are those of `place`."""
        assert self.hidden is not None and self.names
        if len(self.names) == 1:
            os.replace(self.hidden / "0", self.folder / self.names[0])
        else:
            place(self.hidden, self.names)

    def clear(self) -> None:
        """Remove the hidden folder, and folders that were made for it where they are empty."""
        if self.hidden is not None:
            shutil.rmtree(self.hidden, ignore_errors=True)
        for folder in self.made:
            with suppress(OSError):
                folder.rmdir()


def try_folder(folder: Path) -> None:
    """Make and remove a hidden folder in `folder`, or in the next one above that exists.

    Only trying tells on every file system, and for every user, whether files can be written there.

    Raises:
        OSError: they cannot.
    """
    while not folder.exists():
        folder = folder.parent
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, f"{folder} is a file, not a folder")
    os.rmdir(tempfile.mkdtemp(dir=folder, prefix=".", suffix=".part"))


def place(stage: Path, names: Sequence[str]) -> None:
    """Move files of a hidden folder, called ``0``, ``1``, ..., to these names beside it, all of them.

    Raises:
        OSError: the folder cannot be written; before the first file is in its place.
        InputError: it cannot be written any more; as `finish`.
    """
    with (stage / _NAMES).open("w", encoding="utf-8") as stream:
        json.dump(list(names), stream)
        stream.flush()
        os.fsync(stream.fileno())
    ready = stage.parent / READY
    with _locked(stage):
        while True:
            try:
                os.rename(stage, ready)
                break
            except OSError as error:
                if error.errno not in _TAKEN:
                    raise
                finish(stage.parent)  # another process is at it, or was killed at it
        with suppress(OSError):  # it is decided that all are placed: what fails is tried again
            _finish(ready)
    finish(stage.parent)


def finish(folder: str | Path) -> None:
    """Rename into place what a killed process left in a folder; usually there is nothing.

    Raises:
        InputError: there is something, and it cannot be placed.
    """
    ready = Path(folder) / READY
    try:
        while ready.is_dir():
            with _locked(ready) as still:
                if still:
                    _finish(ready)
                    return
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(
            f"files that belong together were left unfinished here, and cannot be placed: {reason}",
            file=ready, remedy="make the folder writable, or delete this one and write them again",
        ) from error  # fmt: skip


def _finish(ready: Path) -> None:
    with suppress(FileNotFoundError):  # the list goes last: without it all are in their places
        names = json.loads((ready / _NAMES).read_text(encoding="utf-8"))
        if not isinstance(names, list) or not all(isinstance(n, str) and _plain(n) for n in names):
            raise ValueError("its list of names is not valid")
        for k, name in enumerate(names):
            with suppress(FileNotFoundError):  # it is in its place already
                os.replace(ready / str(k), ready.parent / name)
        os.unlink(ready / _NAMES)
    try:
        os.rmdir(ready)
    except OSError:
        # once it is empty, another process may put its own in its place, list and all
        with suppress(FileNotFoundError):
            left = os.listdir(ready)
            if left and _NAMES not in left:
                raise


def _plain(name: str) -> bool:
    return name not in ("", ".", "..", READY) and Path(name).name == name and "\0" not in name


@contextmanager
def _locked(folder: Path) -> Iterator[bool]:
    """Hold the lock of a folder; yields whether the folder still exists once the lock is free."""
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except FileNotFoundError:
        yield False
        return
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield _is(folder, handle)
    finally:
        os.close(handle)


def _is(folder: Path, handle: int) -> bool:
    try:
        return os.path.samestat(os.stat(folder), os.fstat(handle))
    except FileNotFoundError:
        return False
