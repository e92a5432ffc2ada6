"""Work for a process of its own, in a file that loads nothing: that process begins with it."""

from __future__ import annotations

import time
from collections.abc import Callable


def forever(progress: Callable[[str], None]) -> None:
    """Never ends by itself."""
    progress("begun")
    while True:
        time.sleep(1.0)


def refuse(progress: Callable[[str], None]) -> None:
    """Fails as a fault of the workbench would."""
    raise ZeroDivisionError
