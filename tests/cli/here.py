"""The command line in the tests' own process: most of the time of a process of its own is its imports."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import traceback
from functools import cache
from pathlib import Path
from subprocess import CompletedProcess
from unittest import mock

import typer.main

from workbench.cli import main

#: The tree of commands is the same every time, and takes longer to make than most commands to run.
_MADE = cache(typer.main.get_command)


def run(*words: object, cwd: Path | None = None, columns: int = 80) -> CompletedProcess[str]:
    """What ``workbench *words`` in a folder prints and ends with; nobody is there to be asked."""
    said = [str(word) for word in words]
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd or Path.cwd()),
        mock.patch.dict(os.environ, {"COLUMNS": str(columns)}),
        mock.patch.object(typer.main, "get_command", _MADE),
        mock.patch.object(sys, "argv", ["workbench", *said]),
        mock.patch.object(sys, "stdin", io.StringIO()),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        code = _ended(err)
    return CompletedProcess(said, code, out.getvalue(), err.getvalue())


def _ended(err: io.StringIO) -> int:
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
