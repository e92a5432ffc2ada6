"""Whose recordings these are: logs by the robot that their files name, a model for each, and who judges."""

from __future__ import annotations

import glob
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from hashlib import sha256
from pathlib import Path

from workbench.core import InputError
from workbench.core.files import read_toml

_FEWEST = 3  # recordings from which one can be spared
_SPARED = 4  # one in so many


@dataclass(frozen=True)
class Robot:
    """One robot of a fleet: its name (`rig` of its recordings), model, recordings that fit and that judge."""

    name: str
    model: str
    training: tuple[Path, ...]
    held_out: tuple[Path, ...] = ()

    @property
    def files(self) -> tuple[Path, ...]:
        """Return all its recordings."""
        return *self.training, *self.held_out


def find_robots(
    paths: Sequence[str], models: Sequence[str], held_out: Sequence[str] | None = None
) -> list[Robot]:
    """Sort recordings by robot.

    Args:
        paths: recordings, patterns of them (``"logs/**/*.toml"``) or folders, which are searched.
        models: a model for all robots; ``RIG=MODEL`` for those whose name fits the pattern RIG, the last that
            fits counts. A folder as MODEL has one file per robot: ``NAME.toml``, ``.xml`` or ``.urdf``.
        held_out: patterns of names of recordings that judge; without them, one in four of each robot with
            three or more, chosen by its name alone, whatever the order and place of the files.

    Returns:
        Robots and their recordings, by name.

    Raises:
        InputError: nothing found, a file that is no TOML, a recording of no robot, a robot without a model.
    """
    files: dict[Path, Path] = {}
    for path in paths:
        for file in _files(path):
            files.setdefault(file.resolve(), file)
    by_rig: dict[str, list[Path]] = {}
    for file in files.values():
        by_rig.setdefault(_rig(file), []).append(file)
    robots = []
    for name, own in sorted(by_rig.items()):
        own.sort(key=lambda f: (f.name, str(f)))
        judge = set(_chosen(own, held_out))
        fit = tuple(f for f in own if f not in judge)
        if not fit:
            raise InputError(
                f"all recordings of '{name}' are held out",
                remedy="leave some to be fitted, or omit --holdout",
            )
        robots.append(Robot(name, _model_of(name, models), fit, tuple(f for f in own if f in judge)))
    return robots


def _chosen(files: Sequence[Path], patterns: Sequence[str] | None) -> list[Path]:
    """Which of a robot's recordings judge."""
    if patterns:
        return [
            f for f in files if any(fnmatchcase(x, p) for p in patterns for x in (f.name, f.stem, str(f)))
        ]
    if len(files) < _FEWEST:
        return []
    # by a hash, so that it goes with no order in which they were made; of the name, so that a file moved or
    # another one added changes little
    ranked = sorted(files, key=lambda f: (sha256(f.stem.encode()).digest(), str(f)))
    return ranked[: max(1, len(files) // _SPARED)]


def _files(path: str) -> list[Path]:
    if Path(path).is_dir():
        found = [f for f in sorted(Path(path).rglob("*.toml")) if "table" in _toml(f)]
        if not found:
            raise InputError("no recording is in this folder", file=path, remedy="name another")
        return found
    if Path(path).exists() or not glob.has_magic(path):
        return [Path(path)]
    found = sorted(glob.glob(path, recursive=True))
    if not found:
        raise InputError("no file matches this pattern", file=path, remedy="check the path")
    return [f for each in found for f in (_files(each) if Path(each).is_dir() else [Path(each)])]


def _toml(file: Path) -> dict[str, object]:
    return read_toml(file, "correct it or leave it out")


def _rig(file: Path) -> str:
    rig = _toml(file).get("rig")
    if not isinstance(rig, str) or not rig.strip():
        raise InputError(
            "does not name its robot", file=file, column="rig",
            remedy="name the robot there, as in rig = \"leg-07\"",
        )  # fmt: skip
    return rig.strip()


def _model_of(name: str, models: Sequence[str]) -> str:
    chosen = None
    for entry in models:
        pattern, _, model = entry.rpartition("=")
        if not pattern or fnmatchcase(name, pattern):
            chosen = model
    if chosen is None:
        raise InputError(f"robot '{name}' has no model", remedy=f"give one: --model '{name}=MODEL'")
    if not Path(chosen).is_dir():
        return chosen
    own = [
        file for ending in (".toml", ".xml", ".urdf") if (file := Path(chosen) / f"{name}{ending}").is_file()
    ]
    if not own:
        raise InputError(
            f"no model of robot '{name}' is in this folder", file=chosen, remedy=f"add {name}.toml"
        )
    return str(own[0])
