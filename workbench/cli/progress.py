"""Progress: what is done and for how much longer, as a moving line, or in a log as rare lines."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .heartbeat import current, duration, waiting


@contextmanager
def progress(quiet: bool) -> Iterator[Any]:
    """Show a line that says what is being done, for how long, and how much time is left.

    In a log or a pipe it is a line of standard error now and then (`heartbeat`), and none of what is done
    sooner. What it gives is told a text, and perhaps which part of the whole is done (0 to 1).
    """
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if quiet or not console.is_terminal or console.is_dumb_terminal:
        heart = None if quiet else current()
        yield (lambda text, done=None: None) if heart is None else heart.tell
        if heart is not None:
            heart.tell("writing the results")
        return
    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    left = TextColumn("{task.fields[left]}")
    with waiting(), Progress(*columns, left, console=console, transient=True) as shown:
        task = shown.add_task("starting", total=None, left="")
        started = time.monotonic()

        def tell(text: str, done: float | None = None) -> None:
            spent = time.monotonic() - started
            left = duration(spent * (1.0 / done - 1.0)) if done and spent > 1.0 else ""
            shown.update(task, description=text, left=f"about {left} left" if left else "")

        yield tell


#: Which part of a diagnosis is done when it begins with this, where one effect is found (by CPU time, on
#: twelve seconds of three axes); of a further step nobody knows beforehand whether it comes.
_SHARES = (
    ("simulating the model", 0.0),
    ("screening effects, step 1", 0.2),
    ("fitting", 0.3),
    ("looking for springs", 0.8),
    ("simulating the noise", 0.85),
    ("screening effects", 0.95),
)


def staged(tell: Any) -> Any:
    """Return the texts of a diagnosis with the share of it that is done."""
    reached = 0.0

    def told(text: str) -> None:
        nonlocal reached
        reached = max(reached, next((share for start, share in _SHARES if text.startswith(start)), 0.0))
        tell(text, reached)

    return told
