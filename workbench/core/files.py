"""Files: output appears whole or not at all, nothing is overwritten unasked, bad input is reported."""

from __future__ import annotations

import os
import signal
import threading
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .errors import InputError
from .unfinished import Stage, try_folder


def as_path(given: Any, what: str, remedy: str = "give one, or name its file") -> Path:
    """Return the path of a file that a caller names, as text or as a path.

    Args:
        given: what was passed as that name.
        what: what is expected, such as ``"a model"``, ``"a recording"``.
        remedy: what to pass.

    Raises:
        InputError: `given` is nothing that names a file.
    """
    if isinstance(given, str | os.PathLike):
        return Path(given)
    kind = "None" if given is None else f"a value of type {type(given).__name__}"
    raise InputError(f"{what} is expected, not {kind}", remedy=remedy)


def write_whole(path: str | Path, data: str | bytes, *, force: bool = False) -> Path:
    """Write `data` to `path` through a hidden folder beside it and a rename.

    The folder of `path` is made if need be; text is written as UTF-8.

    Returns:
        The path written.

    Raises:
        InputError: the file exists and `force` is not set, or the folder cannot be written.
    """
    return write_all({Path(path): data}, force=force)[0]


def write_all(files: Mapping[Path, str | bytes], *, force: bool = False) -> list[Path]:
    """Write files that belong together, all of them or none; inside `together`, with all others of it.

    Whatever goes wrong before the last byte is on the disk leaves what was there before. An interrupt waits
    until all are in their places. A process that is killed leaves at most one hidden folder beside the files,
    which ends in ``.part``: one named after the first file holds what was not complete, and nobody takes
    notice of it; what was complete is put into its places by whoever reads or writes there next (`finish`).

    Returns:
        The paths written.

    Raises:
        InputError: one exists and `force` is not set, or the folder cannot be written.
    """
    with _uninterrupted(), together(), saying(next(iter(files))):
        block = _open.get()
        assert block is not None
        stages = block.stages
        for target in files:
            check_free(target, force=force)
            if target.parent in stages and target.name in stages[target.parent].names:
                raise InputError("is written twice", file=target, remedy="choose another name")
        for folder in {target.parent: None for target in files}:
            stages.setdefault(folder, Stage(folder)).add(
                {target.name: data for target, data in files.items() if target.parent == folder}
            )
    return list(files)


@contextmanager
def together() -> Iterator[None]:
    """Whatever `write_all` writes inside this block appears at its end: all of it, or nothing after an error.

    A block inside another one is a part of it. Files that are not in their places cannot be read yet. All are
    on the disk before the first is renamed; several folders are served one after the other.

    Raises:
        InputError: a folder cannot be written.
    """
    if _open.get() is not None:
        yield
        return
    block = _Block()
    before = _open.set(block)
    try:
        yield
        with _uninterrupted():
            for stage in filter(lambda stage: stage.names, block.stages.values()):
                with saying(stage.folder / stage.names[0]):
                    stage.place()
    finally:
        _open.reset(before)
        for stage in reversed(block.stages.values()):
            stage.clear()
    for act in block.after:
        act()


def when_written(act: Callable[[], object]) -> None:
    """Call `act` once the files of the block around it are in their places; outside of one, now.

    It is not called where the block fails.
    """
    block = _open.get()
    if block is None:
        act()
    else:
        block.after.append(act)


@dataclass
class _Block:
    """What waits for the end of a block: files, by folder, and then what is done `after` they are there."""

    stages: dict[Path, Stage] = field(default_factory=dict)
    after: list[Callable[[], object]] = field(default_factory=list)


_open: ContextVar[_Block | None] = ContextVar("open", default=None)


@contextmanager
def saying(file: str | Path) -> Iterator[None]:
    """Report errors of the disk inside this block with the name of this file.

    Raises:
        InputError: in place of an `OSError`.
    """
    try:
        yield
    except OSError as error:
        raise InputError(f"cannot write: {error.strerror or error}", file=file) from error


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delay an interrupt to the end of this block; only the main thread receives interrupts."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before, came = signal.getsignal(signal.SIGINT), list[tuple[int, Any]]()
    if not callable(before):
        yield
        return
    signal.signal(signal.SIGINT, lambda number, frame: came.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if came:
            before(*came[0])


def read_file(path: Path) -> bytes:
    """Return the content of a file.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return path.read_bytes()
    except IsADirectoryError as error:
        raise InputError("is a folder, not a file", file=path, remedy="name the files in it") from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read ({reason})", file=path, remedy="check the path") from error


def read_toml(path: Path, remedy: str = "correct that line") -> dict[str, Any]:
    """Return the table of a TOML file.

    Raises:
        InputError: it cannot be read, or is no TOML; then with this `remedy`.
    """
    try:
        return tomllib.loads(read_file(path).decode("utf-8-sig"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"is not valid TOML: {error}", file=path, remedy=remedy) from error


def check_free(path: str | Path, *, force: bool) -> None:
    """Refuse an output that exists already, before any work is done.

    Raises:
        InputError: the path exists and `force` is not set, it is a folder, or no file can have this name.
    """
    with saying(path):
        folder, exists = Path(path).is_dir(), Path(path).exists()
    if folder:
        raise InputError("is a folder, not a file", file=path, remedy="give a file name")
    if exists and not force:
        raise InputError("the file exists", file=path, remedy="choose another name or add --force")


def check_place(path: str | Path) -> None:
    """Refuse an output whose folder cannot be written, before any work is done.

    Raises:
        InputError: as it says; where the folder does not exist yet, it could not be made.
    """
    with saying(path):
        try_folder(Path(path).parent)


def check_apart(path: str | Path, read: Iterable[Path]) -> None:
    """Refuse an output that would take the place of a file that was read, whatever else is allowed.

    Raises:
        InputError: `path` is one of the files in `read`.
    """
    with saying(path):
        if Path(path).exists() and any(f.exists() and f.samefile(path) for f in read):
            raise InputError("is an input of this command", file=path, remedy="choose another name")


def check_format(content: Any, known: int, file: str | Path) -> None:
    """Refuse a file of a newer version, before its unknown keys are reported as mistakes.

    A number that is missing or below is left to the file's own grammar: old files keep loading.

    Args:
        content: the whole file, parsed.
        known: the newest format that this version reads.
        file: where it stands.

    Raises:
        InputError: its ``format`` is above `known`.
    """
    found = content.get("format") if isinstance(content, Mapping) else None
    if isinstance(found, int) and found > known:
        raise InputError(
            f"format {found} was written by a newer workbench; this one reads {known}",
            file=file, column="format", remedy="update workbench",
        )  # fmt: skip
