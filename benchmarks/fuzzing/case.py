"""One case: a copy of valid files, one of them spoilt, read; and what came of it."""

from __future__ import annotations

import os
import shutil
import tempfile
import traceback
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from limits import TooLong, at_most

from . import mutate, mutate_table, seeds
from .checks import Wrong
from .kinds import KINDS, STYLES, Kind, repacked

SECONDS = 10.0  # of CPU time that one case may take; a wait is ended by whoever started the process
_LONGEST = 2000  # characters of an error


@dataclass(frozen=True)
class Outcome:
    """What came of a case: `ending` is ``accepted``, ``refused`` or ``failed``, `text` says why."""

    ending: str
    text: str = ""


class Bench:
    """Valid files of one kind, and the folder in which copies of them are spoilt.

    Args:
        name: of the kind.
        folder: an empty one.
    """

    def __init__(self, name: str, folder: Path) -> None:
        self.name, self.kind = name, KINDS[name]
        self._home, self._good = folder, folder / "good"
        self._good.mkdir()
        self.kind.make(self._good)
        self.work = folder / "case"
        self._inner = sorted(p.relative_to(self._good) for p in self._good.rglob("*"))
        self._bytes = {p: (self._good / p).read_bytes() for p in self._inner if (self._good / p).is_file()}
        shutil.rmtree(self._good)

    def lay(self) -> None:
        """The valid files, anew."""
        if self.work.exists():
            shutil.rmtree(self.work)
        self.work.mkdir()
        for part in self._inner:
            if part in self._bytes:
                (self.work / part).write_bytes(self._bytes[part])
            else:
                (self.work / part).mkdir()

    def good(self) -> Outcome:
        """The valid files, read as they are."""
        self.lay()
        return judged(self.kind, self.work, np.random.default_rng(0))

    def spoil(self, random: mutate.Random) -> str:
        """Spoil one of the files; says which and how."""
        file = str(mutate.pick(random, list(self.kind.spoil)))
        style = self.kind.spoil[file]
        if random.random() < 0.03:
            return f"{file}: {_replaced(random, self.work / file)}"
        raw, path = self._bytes[Path(file)], self.work / file
        if style == "bundle" and random.random() < 0.7:
            repacked(self.work, random)
            return f"{file}: repacked"
        if style == "table" and random.random() < 0.6:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    seeds.write_table(path, mutate_table.columns(random, seeds.table()))
                    return f"{file}: columns"
                except Exception:  # what the writer refuses need not be read
                    path.write_bytes(raw)
        text = not _binary(raw)
        choices = [style] * 3 if style in STYLES else []
        choices += ["text", "bytes"] if text else ["bytes"]
        chosen = str(mutate.pick(random, choices))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            path.write_bytes(STYLES[chosen](random, raw))
        return f"{file}: {chosen}"

    def run(self, seed: int, number: int) -> Outcome:
        """The case of this number: everything random in it comes from `seed` and `number`."""
        random = np.random.default_rng([seed, zlib.crc32(self.name.encode()), number])
        self.lay()
        how = self.spoil(random)
        before = self._listing()
        outcome = judged(self.kind, self.work, random)
        if outcome.ending == "refused" and (left := self._listing() - before):
            outcome = Outcome("failed", f"refused, but wrote {sorted(left)[:3]}")
        if strange := {p.name for p in self._home.iterdir()} - {"case"}:
            outcome = Outcome("failed", f"wrote outside of its folder: {sorted(strange)[:3]}")
        return Outcome(outcome.ending, f"{how}: {outcome.text}" if outcome.text else how)

    def _listing(self) -> set[str]:
        files = (str(p.relative_to(self.work)) for p in self.work.rglob("*"))
        return {f for f in files if not f.startswith("unpacked")}


def _binary(raw: bytes) -> bool:
    return b"\0" in raw[:4096] or raw[:2] == b"\x1f\x8b" or raw[:4] in (b"PK\3\4", b"PAR1", b"LOGG")


def _replaced(random: mutate.Random, path: Path) -> str:
    """Something else in a file's place."""
    kind = int(random.integers(6))
    path.unlink()
    match kind:
        case 0:
            path.write_bytes(b"")
        case 1:
            path.mkdir()
        case 2:
            path.symlink_to(path)
        case 3:
            path.symlink_to(path.with_name("nowhere"))
        case 4:
            path.write_bytes(random.bytes(3000))
    return ("empty", "a folder", "a link to itself", "a link to nowhere", "random bytes", "removed")[kind]


def judged(kind: Kind, folder: Path, random: mutate.Random) -> Outcome:
    """Read what lies in a folder, and hold what comes of it against what is promised."""
    from workbench.core import InputError, WorkbenchError

    with _terminal() as said, warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        for silent in (ResourceWarning, DeprecationWarning, PendingDeprecationWarning):  # as Python has it
            warnings.simplefilter("ignore", silent)
        try:
            with at_most(SECONDS, cpu=True):
                result = kind.read(folder, random)
                kind.check(result)
            outcome = Outcome("accepted")
        except WorkbenchError as error:
            outcome = Outcome("refused", str(error))
            if isinstance(error, InputError) and not _names_file(error, folder):
                outcome = Outcome("failed", f"names no file: {error}")
            elif not str(error).isprintable() or len(str(error)) > _LONGEST:
                outcome = Outcome("failed", f"not one printable line: {str(error)[:300]!r}")
        except Wrong as error:
            outcome = Outcome("failed", f"accepted, but {error}")
        except TooLong:
            outcome = Outcome("failed", f"took longer than {SECONDS:g} s")
        except BaseException as error:
            outcome = Outcome("failed", told(error))
    if outcome.ending != "failed" and warned:
        first = warned[0]
        outcome = Outcome("failed", f"warned: {first.filename}:{first.lineno}: {str(first.message)[:200]}")
    if outcome.ending != "failed" and said:
        outcome = Outcome("failed", f"said on the terminal: {said[0][:200]!r}")
    return outcome


def _names_file(error: Any, folder: Path) -> bool:
    return error.file is not None or any(p.name in str(error) for p in folder.rglob("*"))


def told(error: BaseException) -> str:
    """An exception with the last place in the package that it passed."""
    own = [f for f in traceback.extract_tb(error.__traceback__) if f"{os.sep}workbench{os.sep}" in f.filename]
    place = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else "?"
    return f"{type(error).__name__} at {place}: {str(error)[:200]}"


@contextmanager
def _terminal() -> Iterator[list[str]]:
    """What compiled code and Python write on standard output and error, one entry if there is any."""
    said: list[str] = []
    with tempfile.TemporaryFile() as file:
        kept = os.dup(1), os.dup(2)
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        try:
            yield said
        finally:
            for own, fd in zip(kept, (1, 2), strict=True):
                os.dup2(own, fd)
                os.close(own)
            file.seek(0)
            if text := file.read().decode("utf-8", "replace"):
                said.append(text)
