"""Bounds on reading: a file from anywhere may claim any size, and may only name files inside its folder."""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Protocol, cast

from .errors import InputError

MOST_BYTES = 512 * 2**20  # of a table once it is unpacked
MOST_CELLS = 64 * 2**20  # as floats the same
_POINTER = b"version https://git-lfs.github.com/spec/"
_HEADROOM = 4 * 2**30  # address space above what is used already; libraries reserve more than they touch


@contextmanager
def bounded(path: Path) -> Iterator[None]:
    """Turn an allocation by a library that is too large into a one-line error; else the machine swaps.

    Raises:
        InputError: the file needs more memory than a table may.
    """
    try:
        import resource  # not on every system
    except ImportError:
        resource = None
    old = None
    if resource is not None:
        old = resource.getrlimit(resource.RLIMIT_AS)
        limit = _used() + _HEADROOM
        ceilings = [x for x in old if x != resource.RLIM_INFINITY]
        if _used():
            resource.setrlimit(resource.RLIMIT_AS, (min([limit, *ceilings]), old[1]))
    try:
        yield
    except MemoryError as error:
        raise too_large(path) from error
    finally:
        if resource is not None and old is not None:
            resource.setrlimit(resource.RLIMIT_AS, old)


def too_large(path: Path) -> InputError:
    """Return the error for a file that is too large, or claims to be."""
    return InputError(
        f"holds, or claims to hold, more than {MOST_BYTES >> 20} MiB of numbers",
        file=path,
        remedy="cut out the part and the columns that matter",
    )


def check_fetched(path: Path) -> None:
    """Raise InputError if a file is only the placeholder that Git LFS leaves."""
    with path.open("rb") as file:
        if file.read(len(_POINTER)) == _POINTER:
            remedy = "run 'git lfs pull' in its repository"
            raise InputError(
                "is a placeholder of a file that was not fetched with Git LFS", file=path, remedy=remedy
            )


def check_cells(count: int, path: Path) -> None:
    """Raise InputError if a table would have more cells than may be read."""
    if count > MOST_CELLS:
        raise too_large(path)


class Readable(Protocol):
    """A stream that can be read in pieces."""

    def read(self, size: int, /) -> bytes:
        """Return at most `size` bytes."""
        ...


def opened(path: Path) -> IO[bytes]:
    """Return a file open for reading, unpacked as it is read if its name ends in ``.gz``."""
    return cast(IO[bytes], gzip.open(path, "rb")) if path.name.lower().endswith(".gz") else path.open("rb")


def read_bounded(stream: Readable, path: Path) -> bytes:
    """Return a whole stream, unpacked.

    Raises:
        InputError: it is longer than a table may be.
    """
    parts, total = [], 0
    while part := stream.read(2**20):
        total += len(part)
        if total > MOST_BYTES:
            raise too_large(path)
        parts.append(part)
    return b"".join(parts)


def inside(folder: Path, path: Path) -> Path:
    """Return the path with links resolved.

    Raises:
        InputError: it leads out of the folder.
    """
    remedy = "put the file itself there, not a link"
    try:
        real = path.resolve(strict=True)
    except (OSError, RuntimeError) as error:  # a link that leads to itself
        raise InputError("leads nowhere", file=path, remedy=remedy) from error
    if not real.is_relative_to(folder.resolve()):
        raise InputError("is outside its folder", file=path, remedy=remedy)
    return real


def _used() -> int:
    """Return the used address space [bytes]; 0 if the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError, IndexError):
        return 0
    import resource

    return pages * resource.getpagesize()
