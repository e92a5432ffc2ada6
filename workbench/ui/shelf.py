"""Files that the workbench may open: those of the command line, and those in the working directory.

A page sends labels, never paths: what is not on the shelf cannot be opened.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from workbench.core import InputError, Recording
from workbench.core.paths import models_folder
from workbench.effects import load_model
from workbench.models import Model, find_model
from workbench.recordings import describe, load_recording

_MOST = 200  # files of a folder that are looked into
_LARGEST = 1_000_000  # bytes of a description; data tables are not TOML
_ENDINGS = (".toml", ".xml", ".urdf")
#: Model files to what stands in those with something that moves, or that include it; not in parts of others.
_SIGNS = {
    ".xml": re.compile(rb"<mujoco\b.*<(joint|freejoint|include)\b", re.DOTALL),
    ".urdf": re.compile(rb"<robot\b.*<joint\b", re.DOTALL),
}


@dataclass
class Shelf:
    """Models and recordings by the label that a page shows.

    Attributes:
        models, recordings: label to file; what was named stands first, in its order.
        typed: file to what a command line calls it.
        unreadable: TOML files of the working directory that are not offered, and why.
    """

    models: Mapping[str, Path]
    recordings: Mapping[str, Path]
    typed: Mapping[Path, str] = field(default_factory=dict)
    unreadable: Mapping[str, str] = field(default_factory=dict)
    _read: dict[tuple[Path, int], Recording] = field(default_factory=dict, repr=False)

    @staticmethod
    def of(model: str | None, recordings: Sequence[str], folder: Path) -> Shelf:
        """Return the named files, then those in `folder` and its subfolders, then the shipped models.

        Raises:
            InputError: what was named does not exist, or stands twice.
        """
        models = {} if model is None else {model: find_model(model).resolve()}
        named: dict[str, Path] = {}
        for name in recordings:
            path = Path(name).resolve()
            if path in named.values():
                raise InputError("the recording is given twice", file=name, remedy="name each recording once")
            named[name] = path
        found, unreadable = _look_through(folder)
        for kind, into in (("model", models), ("recording", named)):
            for path in found[kind]:
                if path not in into.values():
                    into[path.relative_to(folder.resolve()).as_posix()] = path
        # the reference leg first: it is what the virtual rig is
        for path in sorted(models_folder().glob("*.toml"), key=lambda p: (p.stem != "leg", p.stem)):
            if path.resolve() not in models.values():
                models.setdefault(path.stem, path.resolve())
        typed = {path: name for files in (models, named) for name, path in files.items()}
        return Shelf(_short(models), _short(named), typed, unreadable)

    def model(self, label: str) -> Model:
        """Return the model with a label.

        Raises:
            InputError: not on the shelf, or something is wrong with the file.
        """
        return load_model(_offered(self.models, label, "model"))

    def recording(self, label: str) -> Recording:
        """Return the recording with a label; it is read once, and again if its description changed.

        Raises:
            InputError: not on the shelf, or something is wrong with it.
        """
        path = _offered(self.recordings, label, "recording")
        changed = path.stat().st_mtime_ns if path.exists() else 0
        if (path, changed) not in self._read:
            self._read[path, changed] = load_recording(path)
        return self._read[path, changed]


def _short(files: Mapping[str, Path]) -> dict[str, Path]:
    """The same under the names of the files alone, where these differ."""
    stems = [path.stem for path in files.values()]
    return {path.stem if stems.count(path.stem) == 1 else name: path for name, path in files.items()}


def _offered(shelf: Mapping[str, Path], label: str, kind: str) -> Path:
    if label not in shelf:
        raise InputError(
            f"no {kind} of this name was offered", file=label, remedy="start 'workbench ui' with it"
        )
    return shelf[label]


def _look_through(folder: Path) -> tuple[dict[str, list[Path]], dict[str, str]]:
    """Models and recordings in a folder and those right below it, and files that cannot be read, with why."""
    found: dict[str, list[Path]] = {"model": [], "recording": []}
    unreadable, parts, bare = dict[str, str](), set(), []
    root = folder.resolve()
    for path in _files(root):
        if path.suffix in _SIGNS:
            bare += [path] if _is_model(path) else []
            continue
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8-sig"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError, OSError):
            unreadable[path.relative_to(root).as_posix()] = "is not TOML"
            continue
        kind = "recording" if "table" in table else "model" if "serial" in table else None
        wrong = _wrong(path) if kind == "recording" else ""
        if wrong:
            unreadable[path.relative_to(root).as_posix()] = wrong
        elif kind:
            found[kind].append(path)
        if kind == "model":
            parts.add((path.parent / str(table["serial"])).resolve())
    # the tree of a TOML is that model without its drives
    found["model"] += [path for path in bare if path.resolve() not in parts]
    return found, unreadable


def _wrong(path: Path) -> str:
    """Why a recording cannot be read, as far as its description says; empty where it can."""
    try:
        table = describe(path).table
    except InputError as error:
        return error.problem
    return "" if table.is_file() else f"its table {table.name} is not there"


def _files(root: Path) -> list[Path]:
    """What may be a model or a recording, by name and size."""
    patterns = [f"{below}*{ending}" for ending in _ENDINGS for below in ("", "*/")]
    files = sorted(
        (p for pattern in patterns for p in root.glob(pattern)), key=lambda p: (p.suffix != ".toml", p)
    )
    return [p for p in files[:_MOST] if _may_be_read(p, root)]


def _may_be_read(path: Path, root: Path) -> bool:
    hidden = any(part.startswith(".") for part in path.relative_to(root).parts)
    return not hidden and path.is_file() and path.stat().st_size <= _LARGEST


def _is_model(path: Path) -> bool:
    """Whether an MJCF or URDF looks like one."""
    try:
        return _SIGNS[path.suffix].search(path.read_bytes()) is not None
    except OSError:
        return False
