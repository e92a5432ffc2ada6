"""Buses and virtual motors as separate processes, as long as they are needed."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from workbench.core import WorkbenchError

_PATIENCE = 10.0  # s, to end when asked to


class ProcessError(WorkbenchError):
    """A process of the virtual hardware did not start."""


def start(*words: str, aloud: bool = False) -> subprocess.Popen[str]:
    """Start a command of `workbench` and wait until it is ready.

    Args:
        words: of the command line.
        aloud: whether its error output is that of this process; else it is read when the process ends.

    Raises:
        ProcessError: it ended instead; with what it said.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "workbench.cli", *words],
        stdout=subprocess.PIPE, stderr=None if aloud else subprocess.PIPE, text=True,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert process.stdout
    if process.stdout.readline().strip() != "ready":
        process.kill()
        why = f": {process.stderr.read().strip()}" if process.stderr else ""
        raise ProcessError(f"'workbench {' '.join(words)}' did not start{why}")
    return process


def end(process: subprocess.Popen[str]) -> str:
    """End a process; return the last line of its error output."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
    try:
        _, said = process.communicate(timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        _, said = process.communicate()
    return (said or "").strip().rpartition("\n")[2]


@contextmanager
def virtual_hardware(
    config: str | Path, motors: Sequence[str] = (), aloud: bool = False
) -> Iterator[Callable[[], bool]]:
    """Run buses and motors of a configuration; yield whether both still run.

    Args:
        config: the configuration's file.
        motors: further words for ``workbench can motors``.
        aloud: whether both say what they are, and why they end, on the error output of this process.

    Raises:
        ProcessError: one of them did not start.
    """
    running: list[subprocess.Popen[str]] = []
    try:
        running.append(start("can", "bus", str(config), aloud=aloud))
        running.append(start("can", "motors", str(config), *motors, aloud=aloud))
        yield lambda: all(process.poll() is None for process in running)
    finally:
        for process in reversed(running):
            end(process)
