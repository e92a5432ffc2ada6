"""Long work in a separate process, which can be stopped at any time by ending it."""

from __future__ import annotations

import multiprocessing
import signal
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from workbench.core import WorkbenchError

Tell = Callable[[str, Any], None]


class Worker:
    """At most one piece of work at a time.

    The process lives on between them, as importing costs seconds. `tell` is called from a thread with
    ``("progress", text)`` any number of times, then once with ``("done", result)``, ``("failed", text)`` or,
    where the process ended by itself, ``("failed", ...)``; after `stop` with nothing more.
    """

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("spawn")
        self._process: Any = None
        self._pipe: Connection | None = None
        self._turn, self._busy = 0, False

    def start(self, work: Callable[..., Any], arguments: tuple[Any, ...], tell: Tell) -> None:
        """Run ``work(*arguments, progress=...)`` there; `work` is a function of a module."""
        self.stop()
        if self._process is None:
            own, other = self._context.Pipe()
            self._process = self._context.Process(target=_serve, args=(other,), daemon=True)
            self._process.start()
            other.close()
            self._pipe = own
        self._turn, self._busy = self._turn + 1, True
        following = (self._turn, self._pipe, work, arguments, tell)
        threading.Thread(target=self._follow, args=following, daemon=True).start()

    def stop(self) -> None:
        """Stop the present work at once; without any, nothing happens."""
        if self._busy:
            self.close()

    def close(self) -> None:
        """End the process."""
        self._turn += 1
        self._busy = False
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.join(5)

    def _follow(
        self, turn: int, pipe: Connection, work: Callable[..., Any], arguments: tuple[Any, ...], tell: Tell
    ) -> None:
        try:
            pipe.send((work, arguments))
            while turn == self._turn:
                kind, content = pipe.recv()
                if turn != self._turn:
                    return
                if kind != "progress":
                    self._busy = False
                tell(kind, content)
                if kind != "progress":
                    return
        except (EOFError, OSError):
            if turn == self._turn:
                self.close()
                tell("failed", "the computing process ended unexpectedly; try again")


def _serve(pipe: Connection) -> None:
    """What the process does: one piece of work after another, until nobody asks any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who is in front of the terminal interrupts the server
    while True:
        try:
            work, arguments = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(("done", work(*arguments, progress=lambda text: pipe.send(("progress", text)))))
        except WorkbenchError as error:
            pipe.send(("failed", str(error)))
        except BrokenPipeError:
            return
        except Exception as error:
            pipe.send(("failed", f"this is a fault of workbench: {type(error).__name__}: {error}"))
