"""MuJoCo as it is used here: it prints nothing, writes no log file, and does not look at the clock."""

from __future__ import annotations

import ctypes
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import mujoco

from workbench.core import InputError

_BALANCE = (
    'correct this inertia, or let MuJoCo do it: <compiler balanceinertia="true"/> in <mujoco>, which a URDF '
    "has inside of <robot>"
)


def silence() -> None:
    """Disable ``MUJOCO_LOG.TXT`` and terminal output: the caller handles a diverging run."""
    config = mujoco.MjLogConfig.get()
    config.logto_file = config.logto_console = False
    config.set()


def library() -> Path:
    """Return the shared library of MuJoCo that Python has loaded."""
    names = "libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"
    return next(path for name in names for path in Path(mujoco.__file__).parent.glob(name))


def stop_clock() -> None:
    """Let MuJoCo no longer time the parts of each step, which takes longer than they do in a small machine.

    ``MjData.timer`` stays zero. A clock that somebody has set with ``mujoco.set_mjcb_time`` stays.
    """
    if mujoco.get_mjcb_time() is None:
        with suppress(ValueError):  # a version without a clock
            # for Python's module, None is its own clock; for the library it is no clock
            ctypes.c_void_p.in_dll(ctypes.CDLL(str(library())), "mjcb_time").value = None


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
        remedy = _BALANCE if "balanceinertia" in str(error) else "correct what it names"
        raise InputError(problem, file=file, remedy=remedy) from error


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
