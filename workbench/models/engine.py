"""MuJoCo as it is used here: it prints nothing, and writes no log file."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco

from workbench.core import InputError


def silence() -> None:
    """Disable ``MUJOCO_LOG.TXT`` and terminal output: the caller handles a diverging run."""
    config = mujoco.MjLogConfig.get()
    config.logto_file = config.logto_console = False
    config.set()


@contextmanager
def refused(act: str, file: Path) -> Iterator[None]:
    """Report what MuJoCo refuses inside this block with the name of the file: that it cannot `act`.

    Raises:
        InputError: in place of what MuJoCo raises.
    """
    try:
        yield
    except (ValueError, mujoco.FatalError) as error:
        problem = f"MuJoCo cannot {act}: {error}"
        raise InputError(problem, file=file, remedy="correct what it names") from error


@contextmanager
def warned() -> Iterator[list[str]]:
    """Return MuJoCo's warnings during compilation as a list, not on the terminal."""
    said: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            yield said
        finally:
            said += [str(each.message) for each in caught]
