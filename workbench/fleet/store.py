"""Results of robots on disk, each as soon as it is there: a run that was stopped goes on from them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from workbench.core import FORMAT, InputError
from workbench.core.files import check_format, write_whole
from workbench.core.provenance import PACKAGES, digest, versions
from workbench.models import read_model
from workbench.recordings import source_files
from workbench.report.json import dumps

from .robots import Robot


def fingerprint(robot: Robot, seed: int) -> str:
    """Hash of all that a robot's result depends on: model, recordings with their tables, roles and seed, and
    the versions of what works it out.

    Raises:
        InputError: the model cannot be read.
    """
    parts: list[Any] = [FORMAT, robot.name, seed, versions(PACKAGES)]
    parts += [_digest(file) for file in read_model(robot.model).files]
    for role, files in (("training", robot.training), ("held out", robot.held_out)):
        for file in files:
            parts += [role, file.stem, *(_digest(each) for each in source_files(file))]
    return sha256(json.dumps(parts).encode()).hexdigest()


def files_read(robots: Sequence[Robot]) -> list[Path]:
    """Return all files that robots' results depend on, each once: of models, recordings and tables.

    What is not there is left out: the robot whose recording it is has failed, and says so.

    Raises:
        InputError: a model cannot be read.
    """

    def each() -> Iterator[Path]:
        for robot in robots:
            yield from read_model(robot.model).files
            for recording in robot.files:
                yield from source_files(recording)

    return [file for file in dict.fromkeys(each()) if file.is_file()]


def result_file(folder: Path, name: str) -> Path:
    """Return where a robot's result is kept; its improved model lies beside it, ending in ``.toml``."""
    plain = re.sub(r"[^\w.-]+", "_", name)
    # names that differ in what a file's name cannot hold must not share a file
    tail = "" if plain == name else "-" + sha256(name.encode()).hexdigest()[:6]
    return folder / f"{plain}{tail}.json"


def stored(folder: Path, name: str) -> dict[str, Any] | None:
    """Return a robot's result as it was kept; None where there is none.

    Raises:
        InputError: the file cannot be read, or is something else.
    """
    file = result_file(folder, name)
    if not file.exists():
        return None
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        check_format(content, FORMAT, file)
        if content["rig"] == name and "inputs" in content:
            return content
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read ({reason})", file=file, remedy="check the path") from error
    except (ValueError, KeyError, TypeError):
        pass
    raise InputError(f"is not a result of robot '{name}'", file=file, remedy="choose another folder")


def keep(folder: Path, content: dict[str, Any]) -> None:
    """Write a robot's result, in place of an earlier one."""
    write_whole(result_file(folder, content["rig"]), dumps(content), force=True)


def _digest(file: Path) -> str | None:
    """Of a file; None where it cannot be read, which its robot says when its turn comes."""
    try:
        return digest(file)
    except InputError:
        return None
