"""A disk that fails at the nth call: every open, write, fsync, rename and removal in some folder is tried."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

#: Of `os`; `write` and `flush` of a file that was opened count as well.
CALLS = ("open", "fsync", "replace", "rename", "mkdir", "write", "unlink", "rmdir")
MODES = set("wax+")


class Disk:
    """Fails once, at call `at` of those that change what is in `folder`, while it is entered.

    Only what touches that folder counts: modules and models are read as always.
    """

    def __init__(self, at: int, folder: Path) -> None:
        self.count, self.at, self.folder = 0, at, folder.resolve()
        self._patch = pytest.MonkeyPatch()

    def __enter__(self) -> Disk:
        for name in CALLS:
            self._patch.setattr(os, name, self._counted(getattr(os, name)))
        opened = self._opening(io.open)
        self._patch.setattr(io, "open", opened)
        self._patch.setattr("builtins.open", opened)
        return self

    def __exit__(self, *of: object) -> None:
        self._patch.undo()

    @property
    def failed(self) -> bool:
        """Whether there were so many calls."""
        return self.count >= self.at

    def _fall(self) -> None:
        self.count += 1
        if self.count == self.at:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _counted(self, real: Callable) -> Callable:
        def call(place, *args, **more):
            if self._inside(place):
                self._fall()
            return real(place, *args, **more)

        return call

    def _opening(self, real: Callable) -> Callable:
        def call(place, mode="r", *args, **more):
            if not (MODES & set(mode) and self._inside(place)):
                return real(place, mode, *args, **more)
            self._fall()
            stream = real(place, mode, *args, **more)
            for name in ("write", "flush"):
                setattr(stream, name, self._each(getattr(stream, name)))
            return stream

        return call

    def _each(self, real: Callable) -> Callable:
        def call(*args):
            self._fall()
            return real(*args)

        return call

    def _inside(self, place: object) -> bool:
        if isinstance(place, int):
            try:
                place = os.readlink(f"/proc/self/fd/{place}")
            except OSError:
                return False
        return isinstance(place, str | os.PathLike) and self.folder in Path(os.path.abspath(place)).parents


def files(folder: Path) -> dict[str, bytes]:
    """What lies in a folder, hidden or not."""
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


def sweep(folder: Path, most: int = 300) -> Iterator[Disk]:
    """A disk over a folder of its own that fails at call 1, 2, ..., until it was not called so often."""
    for at in range(1, most):
        own = folder / f"at{at}"
        own.mkdir()
        disk = Disk(at, own)
        yield disk
        if not disk.failed:
            assert at > 5, "hardly anything was written"
            return
    raise AssertionError(f"no end after {most} calls")
