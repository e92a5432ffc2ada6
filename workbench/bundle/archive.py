"""The parts of a zip archive of a stranger, or one line that says why they are not to be had."""

from __future__ import annotations

import stat
import zipfile
import zlib
from pathlib import Path, PurePosixPath

from workbench.core import InputError

MOST_PARTS = 1000
MOST_BYTES = 256 * 2**20  # of all parts unpacked
_REMEDY = "make it with `workbench export`"
#: What a zip archive that is damaged ends in; a RuntimeError is a part that is encrypted, or packed in a way
#: that is not known here, an IndexError one without a name.
_DAMAGED = (
    OSError, EOFError, ValueError, KeyError, IndexError, RuntimeError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip


def read_parts(file: Path) -> dict[str, bytes]:
    """Name -> content of every part; nothing is unpacked onto the disk.

    Raises:
        InputError: no zip archive, or damaged; more or larger parts than a bundle may have; a part that is a
            link, stands twice, or whose name leads out of the bundle.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            entries = [entry for entry in archive.infolist() if not entry.is_dir()]
            _check_entries(entries, file)
            return {entry.filename: archive.read(entry) for entry in entries}
    except FileNotFoundError as error:
        raise InputError("no such bundle", file=file, remedy="name a .zip of `workbench export`") from error
    except _DAMAGED as error:
        raise InputError("not a policy bundle", file=file, remedy=_REMEDY) from error


def _check_entries(entries: list[zipfile.ZipInfo], file: Path) -> None:
    if len(entries) > MOST_PARTS:
        raise InputError(f"has {len(entries)} parts", file=file, remedy=_REMEDY)
    # zipfile reads no more of a part than its entry says, so that what is summed here is what is read
    if sum(entry.file_size for entry in entries) > MOST_BYTES:
        problem = f"unpacks to more than {MOST_BYTES >> 20} MiB"
        raise InputError(problem, file=file, remedy=_REMEDY)
    names = [entry.filename for entry in entries]
    for entry, name in zip(entries, names, strict=True):
        path = PurePosixPath(name)
        if path.is_absolute() or ".." in path.parts or "\\" in name or ":" in name:
            raise InputError(f"'{name}' leads out of the bundle", file=file, remedy=_REMEDY)
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise InputError(f"'{name}' is a link", file=file, remedy=_REMEDY)
        if names.count(name) > 1:
            raise InputError(f"'{name}' occurs twice", file=file, remedy=_REMEDY)
