"""What is being done, and for how long yet: a line that moves in a terminal, one now and then in a log."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer

_SILENCE_S = 30.0


@contextmanager
def progress(quiet: bool) -> Iterator[Any]:
    """A line that says what is being done, for how long, and how long yet.

    In a log or a pipe it is a line of standard error every half minute, and none of what is done sooner. What
    it gives is told a text, and perhaps which part of the whole is done (0 to 1).
    """
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield (lambda text, done=None: None) if quiet else _now_and_then()
        return
    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    with Progress(*columns, TextColumn("{task.fields[left]}"), console=console, transient=True) as shown:
        task = shown.add_task("starting", total=None, left="")
        started = time.monotonic()

        def tell(text: str, done: float | None = None) -> None:
            spent = time.monotonic() - started
            left = duration(spent * (1.0 / done - 1.0)) if done and spent > 1.0 else ""
            shown.update(task, description=text, left=f"about {left} left" if left else "")

        yield tell


def _now_and_then() -> Any:
    """Tells what is being done if nothing was told for a while."""
    started = last = time.monotonic()

    def tell(text: str, done: float | None = None) -> None:
        nonlocal last
        del done
        now = time.monotonic()
        if now - last >= _SILENCE_S:
            typer.echo(f"after {duration(now - started)}: {text}", err=True)
            last = now

    return tell


#: Which part of a diagnosis is done when it begins with this, where one effect is found (by CPU time, on
#: twelve seconds of three axes); of a further step nobody knows beforehand whether it comes.
_SHARES = (
    ("simulating the model", 0.0),
    ("screening effects, step 1", 0.2),
    ("fitting", 0.3),
    ("looking for springs", 0.8),
    ("found", 0.85),
    ("screening effects", 0.95),
)


def staged(tell: Any) -> Any:
    """A diagnosis' texts, told with the part of it that is done."""
    reached = 0.0

    def told(text: str) -> None:
        nonlocal reached
        reached = max(reached, next((share for start, share in _SHARES if text.startswith(start)), 0.0))
        tell(text, reached)

    return told


def duration(seconds: float) -> str:
    """A time in words."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
