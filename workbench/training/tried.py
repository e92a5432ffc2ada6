"""A task of one's own tried before it trains: what its functions do wrong is said of its file, by line."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import InputError

from .draws import Draws
from .environment import Environment
from .machine import Machine
from .task import Task
from .worlds import BatchWorlds

_WORLDS = 3  # another number than of anything else, so that shapes tell


def called(what: str, file: Path, function: Callable[..., Any], *given: Any) -> Any:
    """What a function of somebody's file returns.

    Args:
        what: it is, for the message.
        file: where it stands.
        function: to be called.
        given: to it.

    Raises:
        InputError: it fails; says what, why and in which line.
    """
    try:
        return function(*given)
    except Exception as error:
        found = traceback.extract_tb(error.__traceback__)
        rows = [f.lineno for f in found if f.filename == str(file)]
        raise InputError(
            f"{what} fails: {type(error).__name__}: {error}", file=file, row=rows[-1] if rows else None,
            remedy="correct the line" if rows else "correct it",
        ) from error  # fmt: skip


def try_task(task: Task, machine: Machine, file: Path) -> None:
    """Call every function of a task in a few worlds, before hours of training do.

    Args:
        task: of a Python file.
        machine: with which it will train.
        file: its own.

    Raises:
        InputError: a function fails, gives arrays of another shape, or what is no number; says which.
    """
    n = machine.size
    numbers = called("numbers", file, task.numbers, n)
    draws = Draws(np, 0, np.zeros(1))
    _check("command", file, called("command", file, task.command, draws, _WORLDS, machine), numbers)
    now = Environment(task, machine, BatchWorlds(machine, _WORLDS, threads=1), _WORLDS).situation()
    now.fallen = np.zeros(_WORLDS, bool)
    for entry in (*task.observations, *task.privileged):
        what = f"observation '{entry.name}'"
        _check(what, file, called(what, file, entry.function, now), None)
    for term in task.rewards:
        what = f"reward '{term.name}'"
        _check(what, file, called(what, file, term.function, now), 0)
    if task.trial is not None:
        found = called("trial", file, task.trial, machine)
        _check("trial", file, found, numbers, worlds=1)
    if task.goal is not None:
        both = called("goal", file, task.goal, np, now.command, now.elapsed)
        for what, values in zip(("angles of goal", "speeds of goal"), both, strict=True):
            _check(what, file, values, n)


def _check(what: str, file: Path, values: Any, count: int | None, worlds: int = _WORLDS) -> None:
    """An array (worlds, count) of numbers; (worlds,) where `count` is 0, of any width where it is None.

    Raises:
        InputError: it is something else.
    """
    try:
        found = np.asarray(values, float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} gives no array of numbers", file=file, remedy="return one") from error
    width = f", {count}" if count else "," if count == 0 else ", k"
    right = found.ndim == 2 if count is None else found.shape == ((worlds, count) if count else (worlds,))
    if not right or found.shape[0] != worlds:
        raise InputError(
            f"{what} gives an array {found.shape} in {worlds} worlds, not ({worlds}{width})", file=file,
            remedy="give one row for each world",
        )  # fmt: skip
    if not np.isfinite(found).all():
        problem = f"{what} gives a value that is not a finite number"
        raise InputError(problem, file=file, remedy="keep it finite")
