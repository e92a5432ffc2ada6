"""The folder of a run: its settings at the start; no run is lost or mixed with another by mistake."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from workbench.core import InputError
from workbench.core.files import saying, write_whole
from workbench.models import Model, write_model

from .machine import Machine
from .task import Task
from .task_file import TASK_FILE

CONFIG, CHECKPOINT, MJCF, MODEL = "config.json", "checkpoint.pt", "machine.xml", "model"


def open_folder(
    folder: Path, config: dict[str, Any], task: Task, machine: Machine, *, resume: bool, force: bool
) -> None:
    """Write the settings of the run; a run is continued only with the same settings, and replaced only with
    force.

    A run that is there is gone once all that begins the new one is on the disk: a disk that fails before
    leaves the old one as it was. Where the process is killed meanwhile, it lies in hidden files (``.part``).

    Raises:
        InputError: the folder holds a run already (neither resumed nor forced), or another one (resumed); or
            it cannot be written.
    """
    file = folder / CONFIG
    if resume:
        try:
            before = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError("no run to continue", file=file, remedy="name the folder of a run") from error
        for key in ("task", "variant", "model", "processes"):
            if before.get(key) != config[key]:
                raise InputError(
                    f"the run has another {key}",
                    file=file,
                    column=key,
                    remedy="resume with the value of the first run",
                )
        old, new = before.get("settings", {}), config["settings"]
        for key in ("worlds", "seed", "learning", "randomisation"):
            if old.get(key) != json.loads(json.dumps(new[key])):
                raise InputError(
                    f"the run began with {key} = {old.get(key)}", file=file, column=key,
                    remedy="resume with the same",
                )  # fmt: skip
    elif (folder / CHECKPOINT).exists() and not force:  # a run that ended before its first one begins anew
        raise InputError(
            "the folder holds a run",
            file=folder,
            remedy="choose another, continue with --resume, or start again with --force",
        )
    with _aside([] if resume else [folder / name for name in (CHECKPOINT, MODEL, MJCF)]):
        copy_model(machine.model, folder / MODEL)
        if task.source is not None:
            write_whole(folder / MODEL / f"{TASK_FILE}{task.suffix}", task.source, force=True)
        write_whole(folder / MJCF, machine.xml, force=True)
        write_whole(file, json.dumps(config, indent=1) + "\n", force=True)  # last: it decides whose run it is


@contextmanager
def _aside(paths: list[Path]) -> Iterator[None]:
    """Puts what is there out of the way, and back again where what comes in its place fails."""
    moved: list[tuple[Path, Path]] = []
    try:
        for path in filter(Path.exists, paths):
            hidden = path.with_name(f".{path.name}.part")
            with saying(path):
                _remove(hidden)  # of a process that was killed
                path.rename(hidden)
            moved.append((path, hidden))
        yield
    except BaseException:
        for path, hidden in moved:
            with suppress(OSError):
                _remove(path)
                hidden.rename(path)
        raise
    for _, hidden in moved:
        with suppress(OSError):
            _remove(hidden)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def copy_model(model: Model, folder: Path) -> None:
    """Write the model of the leg as a file, with all files that it refers to.

    Raises:
        InputError: they cannot be written.
    """
    copied: dict[Path, Path] = {}
    for path in replace(model, source=None).files:  # its own is written anew
        copied[path] = folder / model.place(path)
        write_whole(copied[path], path.read_bytes(), force=True)
    chain = model.closed_chain
    own = replace(
        model,
        serial=copied[model.serial].resolve(),
        closed_chain=chain and replace(chain, file=copied[chain.file].resolve()),
    )
    write_model(own, folder / "model.toml", force=True)
