"""The command line in the tests' own process: most of the time of a process of its own is its imports."""

from __future__ import annotations

import contextlib
import io
import os
import pty
import sys
import traceback
from functools import cache
from pathlib import Path
from subprocess import CompletedProcess
from threading import Thread
from typing import TextIO
from unittest import mock

import typer.main

from workbench.cli import main

#: The tree of commands is the same every time, and takes longer to make than most commands to run.
_MADE = cache(typer.main.get_command)


def run(*words: object, cwd: Path | None = None, columns: int = 80) -> CompletedProcess[str]:
    """What ``workbench *words`` in a folder prints and ends with; nobody is there to be asked."""
    said = [str(word) for word in words]
    out, err = io.StringIO(), io.StringIO()
    code = _ended(said, cwd, columns, io.StringIO(), out, err)
    return CompletedProcess(said, code, out.getvalue(), err.getvalue())


def run_at_a_terminal(answers: str, *words: object, cwd: Path, columns: int = 80) -> CompletedProcess[str]:
    """The same at a terminal, where `answers` are typed; what is shown is all in ``stdout``."""
    ours, theirs = pty.openpty()
    os.write(ours, f"{answers}\n".encode())
    shown: list[bytes] = []
    reader = Thread(target=_follow, args=(ours, shown))
    reader.start()
    said = [str(word) for word in words]
    try:
        with os.fdopen(os.dup(theirs), "r") as keys, os.fdopen(theirs, "w") as screen:
            code = _ended(said, cwd, columns, keys, screen, screen)
    finally:
        reader.join()
        os.close(ours)
    return CompletedProcess(said, code, b"".join(shown).decode(), "")


def _follow(terminal: int, shown: list[bytes]) -> None:
    with contextlib.suppress(OSError):  # the other end is closed
        while part := os.read(terminal, 4096):
            shown.append(part)


def _ended(said: list[str], cwd: Path | None, columns: int, keys: TextIO, out: TextIO, err: TextIO) -> int:
    with (
        contextlib.chdir(cwd or Path.cwd()),
        mock.patch.dict(os.environ, {"COLUMNS": str(columns)}),
        mock.patch.object(typer.main, "get_command", _MADE),
        mock.patch.object(sys, "argv", ["workbench", *said]),
        mock.patch.object(sys, "stdin", keys),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        return _code(err)


def _code(err: TextIO) -> int:
    try:
        main()
    except SystemExit as end:
        if isinstance(end.code, str):
            err.write(end.code)
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:  # what a process of its own would show
        err.write(traceback.format_exc())
        return 1
    return 0
