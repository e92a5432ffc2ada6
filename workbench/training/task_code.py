"""A task of your own as a Python file that contains ``TASK = Task(...)``.

The file is run as any Python is: it is for those who wrote it. A bundle carries its text to be read, and
    nobody runs
that: whoever evaluates names the file himself, and it has to be the same.
"""

from __future__ import annotations

import traceback
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from workbench.core import InputError

from .task import Task


def task_from_code(text: str, file: Path) -> Task:
    """Run the Python file of a task, and return the task.

    Raises:
        InputError: it fails, with its line; or makes no ``TASK``.
    """
    module = ModuleType(file.stem)
    module.__file__ = str(file)
    try:
        exec(compile(text, str(file), "exec"), module.__dict__)
    except Exception as error:
        lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(file)]
        row = lines[-1] if lines else getattr(error, "lineno", None)
        raise InputError(
            f"fails: {type(error).__name__}: {error}", file=file, row=row, remedy="correct the line"
        ) from error
    task = getattr(module, "TASK", None)
    if not isinstance(task, Task):
        raise InputError(
            "makes no TASK", file=file, column="TASK",
            remedy="end it with TASK = Task(...), of workbench.training; docs/training.md has one",
        )  # fmt: skip
    return replace(task, source=text, suffix=".py")


def same_code(text: str, file: Path | None, bundle: Path | None) -> Task:
    """Return the task of a bundle that contains its Python file as text.

    Raises:
        InputError: the file is not named, or is another one.
    """
    if file is None:
        raise InputError(
            "its task is a Python file, and nothing runs code out of a bundle", file=bundle,
            remedy="name the file itself: --task my_task.py",
        )  # fmt: skip
    try:
        own = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read: {error}", file=file, remedy="name the task's file") from error
    if own != text:
        raise InputError(
            "is not the file that the policy was trained with",
            file=file,
            remedy="take that of the run's folder",
        )
    return task_from_code(own, file)
