"""Ends every run with damping: at its end, a fault, a signal, an exception, the parent's death."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any

from workbench.can import CanConfig
from workbench.core import WorkbenchError

from .deadman import Deadman
from .gpio import stop_line
from .host import Host

#: What asks a program to end, or would keep it from commanding its drives: each presses the emergency stop.
SIGNALS = tuple(getattr(signal, f"SIG{name}") for name in ("INT", "TERM", "HUP", "QUIT", "TSTP"))


class RunError(WorkbenchError):
    """A run that ended early, with the reason."""

    exit_code = 1


@contextmanager
def brought_down(host: Host) -> Iterator[None]:
    """Damp and then disable every drive at the end of the block, before anything else happens.

    Signals press the emergency stop, and go on doing so until the drives are disabled: a second one, sent out
    of impatience, skips nothing. Outside the main thread no signal can be taken.

    Args:
        host: the loop that the block runs.

    Raises:
        RunError: the block broke off with an exception that nobody meant.
    """
    before: dict[int, Any] = {}

    def press(number: int, frame: object) -> None:
        host.operator.press(signal.Signals(number).name)

    with suppress(ValueError):  # not the main thread
        for number in SIGNALS:
            before[number] = signal.signal(number, press)
    try:
        try:
            yield
        finally:
            host.close()
    except WorkbenchError:
        raise
    except Exception as error:
        said = f"{type(error).__name__}: {error}"
        raise RunError(f"the run was aborted, and every drive was damped and disabled: {said}") from error
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def on_hardware(host: Host, config: CanConfig) -> Iterator[None]:
    """Start what only real hardware needs: a thread by the policy, a watch on the parent, the button.

    Raises:
        InputError: the button's line cannot be had.
    """
    host.operator.watches.append(orphaned())
    loop = config.loop
    host.deadman = Deadman(host.drives, loop.period_s, 3 * loop.period_s, config.clock.machine)
    with stop_line(config) as watches, host.deadman.watching():
        host.operator.watches += watches
        yield


def orphaned() -> Callable[[], str | None]:
    """Return a watch that stops the run when the parent process is gone, as after a dropped connection."""
    parent = os.getppid()
    return lambda: "the end of its parent process" if os.getppid() != parent else None


def exit_code(result: Mapping[str, Any]) -> int:
    """Return a run's exit code: 0, 1 after a fault; if stopped, 128 plus the signal's number, or 130."""
    if not result["stopped"]:
        return 1 if result["fault"] else 0
    stopped_by = result["stopped_by"] or ""
    number = getattr(signal, stopped_by, None) if stopped_by.startswith("SIG") else None
    return 128 + int(number) if number is not None else 130
