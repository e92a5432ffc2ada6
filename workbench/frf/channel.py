"""What the rows and columns of a frequency response are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core import InputError


@dataclass(frozen=True)
class Channel:
    """One input or output: `signal` of a recording, its `axis`, and the SI `unit`."""

    signal: str
    axis: str
    unit: str

    def __str__(self) -> str:
        return f"{self.signal}_{self.axis}"


def place_of(wanted: str | int, channels: Sequence[Channel]) -> int:
    """Return the place of a channel that is named by number, by axis, or by signal and axis.

    Raises:
        InputError: a name that is not there, or stands for several.
    """
    if isinstance(wanted, int):
        return wanted
    found = [k for k, c in enumerate(channels) if wanted in (c.axis, str(c))]
    if len(found) != 1:
        known = ", ".join(str(c) for c in channels)
        what = "is not a signal of this response" if not found else "stands for several signals"
        raise InputError(f"'{wanted}' {what}", remedy=f"choose from {known}")
    return found[0]
