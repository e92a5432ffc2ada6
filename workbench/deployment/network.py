"""What a loop needs of its buses and its clock; real ones and simulated ones look alike."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from workbench.can import Frame


class Arrival(NamedTuple):
    """A frame that came in.

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
    """Buses by name, and a monotonic clock; no wall clock decides anything."""

    def now(self) -> float:
        """Monotonic time [s]."""
        ...

    def sleep_until(self, time: float) -> None:
        """Returns at `time` [s], or at once where that is past."""
        ...

    def send(self, bus: str, frame: Frame) -> bool:
        """Queues a frame; False where the bus is off or its queue full."""
        ...

    def receive(self, until: float) -> list[Arrival]:
        """What has come in; waits for the first until `until` [s]."""
        ...

    def ok(self, bus: str) -> bool:
        """Whether a bus carries frames."""
        ...

    def flush(self, bus: str) -> None:
        """Forgets what is queued and was not sent."""
        ...

    def restart(self, bus: str) -> None:
        """Brings back a bus that was off."""
        ...
