"""A policy that does not answer: a thread damps the drives instead, and finally ends the program.

While the loop waits for its controller nobody commands the drives; their watchdogs would let go of them,
limp. The thread needs the interpreter: it runs beside a policy that waits or computes outside of it (ONNX
Runtime) or in Python, and not beside compiled code that keeps the interpreter to itself, nor in a process
that is stopped (SIGSTOP). Those, and `kill -9`, are left to the drives' watchdogs.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from math import ceil

from .drives import CALM, Drives, Frames

_PATIENCE = 1.0  # s that a controller may take before the program is ended

#: Ends the process at once, with this code: the loop's own thread is not to be had.
End = Callable[[int], object]


class Deadman:
    """A watch over every call of a controller.

    Args:
        drives: to damp.
        period: of the loop; the thread looks once in each [s].
        after: how long a call may take before drives are damped [s].
        machine: how long so many seconds of the loop's clock are for the machine [s].
        end: what ends the program, damped and disabled, where the call takes longer than a second.
    """

    def __init__(
        self, drives: Drives, period: float, after: float, machine: Callable[[float], float],
        end: End = os._exit,
    ) -> None:  # fmt: skip
        self._drives, self._machine, self._end = drives, machine, end
        self._period, self._late = period, ceil(after / period)
        self._lock, self._over = threading.Lock(), threading.Event()
        self._calls, self._inside = 0, False
        self._damping: Sequence[Frames] = ()
        self._thread = threading.Thread(target=self._watch, name="deadman", daemon=True)
        self.acted = 0

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Watch while the loop runs."""
        self._thread.start()
        try:
            yield
        finally:
            self._over.set()
            self._thread.join()

    @contextmanager
    def over(self, damping: Sequence[Frames]) -> Iterator[None]:
        """Watch one call of a controller; the given frames are sent if it does not answer."""
        with self._lock:
            self._damping, self._inside, self._calls = damping, True, self._calls + 1
        try:
            yield
        finally:
            with self._lock:  # waits where drives are being damped: no two threads are on a bus
                self._inside = False

    def _watch(self) -> None:
        call = waited = 0
        while not self._over.wait(self._machine(self._period)):
            with self._lock:
                if not self._inside:
                    waited = 0
                    continue
                waited, call = (waited + 1 if call == self._calls else 0), self._calls
                if waited < self._late:
                    continue
                self.acted += 1
                with suppress(Exception):
                    self._drives.send(self._damping)
                if waited * self._period >= _PATIENCE + CALM:
                    self._give_up()
                    return

    def _give_up(self) -> None:
        self._drives.disable()
        with suppress(Exception):
            line = (
                "error: the policy does not answer: every drive was damped and disabled, and the program ends"
            )
            print(line, file=sys.stderr, flush=True)
        self._end(1)
