"""Interface of buses and clock for a loop; real and simulated ones are the same."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from workbench.can import Frame


class Arrival(NamedTuple):
    """A received frame.

    Attributes:
        bus: name of its bus.
        stamp: monotonic time at which it was complete on the wire [s].
        frame: the frame.
        sent: it is our own, complete on the wire (transmit echo).
    """

    bus: str
    stamp: float
    frame: Frame
    sent: bool = False


class Network(Protocol):
    """Buses by name, and a monotonic clock; the wall clock is used for nothing."""

    def now(self) -> float:
        """Return the monotonic time [s]."""
        ...

    def sleep_until(self, time: float) -> None:
        """Return at `time` [s], or immediately if that is past."""
        ...

    def send(self, bus: str, frame: Frame) -> bool:
        """Queue a frame; return False if the bus is off or its queue full."""
        ...

    def receive(self, until: float) -> list[Arrival]:
        """Return the received frames; wait for the first until `until` [s]."""
        ...

    def ok(self, bus: str) -> bool:
        """Return whether a bus carries frames."""
        ...

    def flush(self, bus: str) -> None:
        """Discard queued frames."""
        ...

    def restart(self, bus: str) -> None:
        """Restart a bus that was off."""
        ...
