"""What a long command is doing, said in a line now and then to somebody who sees nothing else of it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

import typer

from workbench.core.text import plain

FIRST_S, EVERY_S = 20.0, 30.0  # nobody waits for a minute without a line, and nothing quick says one
_running: list[Heartbeat] = []  # of the command that runs, if it has one


def duration(seconds: float) -> str:
    """A time in words."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"


class Heartbeat:
    """Repeats what was told last with the time gone by, in a thread: what computes does not have to call.

    Args:
        text: what is being done as long as nothing is told.
        first, every: when the first line is said, and how long none is said after one [s].
        say: given each line.
        clock: the time [s].
    """

    def __init__(
        self,
        text: str,
        *,
        first: float = FIRST_S,
        every: float = EVERY_S,
        say: Callable[[str], None] = lambda line: typer.echo(plain(line), err=True),
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._say, self._clock, self._every = say, clock, every
        self._started = clock()
        self._due = self._started + first
        self._now = text, self._started
        self._said = ""
        self._over = threading.Event()
        self._hushed = 0

    def tell(self, text: str, done: float | None = None) -> None:
        """What is being done from now on; `done` is for bars, which know what is left."""
        del done
        if text != self._now[0]:
            self._now = text, self._clock()

    def beat(self) -> None:
        """Say the line that is due, if one is."""
        now, (text, since) = self._clock(), self._now
        if now < self._due or self._hushed:
            return
        stands = f"still {text}, {duration(now - since)}" if text == self._said else text
        self._due, self._said = now + self._every, text
        self._say(f"after {duration(now - self._started)}: {stands}")

    @contextmanager
    def hushed(self) -> Iterator[None]:
        """No line meanwhile: a bar moves, or a question waits for its answer."""
        self._hushed += 1
        try:
            yield
        finally:
            self._hushed -= 1
            self._due = max(self._due, self._clock() + self._every)

    def start(self) -> None:
        """Begin to beat, until `stop` or the end of the program."""
        threading.Thread(target=self._run, name="heartbeat", daemon=True).start()

    def stop(self) -> None:
        """No line any more."""
        self._over.set()

    def _run(self) -> None:
        with suppress(OSError, ValueError):  # whoever read it is gone
            while not self._over.wait(max(self._due - self._clock(), min(0.5, 0.1 * self._every))):
                self.beat()


def begin(context: typer.Context, quiet: bool) -> bool:
    """Start the heartbeat of a command, which ends with it, unless it is to be `quiet`; returns that."""
    for left in list(_running):  # a command line that was refused behind `--quiet` never ran, nor ended
        _end(left)
    if not quiet and not context.resilient_parsing:
        program = context.find_root().command_path  # "workbench", or "python -m workbench"
        text = context.command_path.removeprefix(program).strip() or program
        heart = Heartbeat(text, first=FIRST_S, every=EVERY_S)
        _running.append(heart)
        context.call_on_close(lambda: _end(heart))
        heart.start()
    return quiet


def _end(heart: Heartbeat) -> None:
    heart.stop()
    if heart in _running:
        _running.remove(heart)


def current() -> Heartbeat | None:
    """The heartbeat of the command that runs; None where it is quiet, or none runs."""
    return _running[-1] if _running else None


@contextmanager
def waiting() -> Iterator[None]:
    """A person is asked something, and nothing may be written into the question."""
    heart = current()
    if heart is None:
        yield
    else:
        with heart.hushed():
            yield
