"""A model of one CAN bus: who sends when, how long it takes, and the effect of errors.

Whenever the bus falls idle, the lowest identifier among the oldest frames of all nodes wins. A frame takes
its own bits, stuffing included. A damaged one is cut off by an error frame and sent again; a node whose
errors add up to more than 255 is off the bus, its queue flushed, until it is told to come back.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from .flexible import seconds
from .frame import Frame

_ERROR_BITS = 23  # flag 6 to 12, delimiter 8, intermission 3
_WARN, _OFF = 127, 255  # transmit errors above which a node is passive, or off
QUEUE = 32  # frames that a node holds

#: Called with the time at which a frame is complete [s], and the frame.
Receiver = Callable[[float, Frame], None]


@dataclass(eq=False)
class Node:
    """A sender and receiver on the bus.

    Attributes:
        name: of the node.
        receive: is called with every frame of the others.
        echo: is called with every own frame that went out.
        errors: count of transmit errors, as the standard counts.
        off: whether it is off the bus.
        queue: frames to send and when each may start [s].
    """

    name: str
    receive: Receiver
    echo: Receiver | None = None
    errors: int = 0
    off: bool = False
    queue: deque[tuple[float, Frame]] = field(default_factory=deque)

    @property
    def state(self) -> str:
        """Return ``active``, ``passive`` or ``off``."""
        return "off" if self.off else "passive" if self.errors > _WARN else "active"

    def come_back(self) -> None:
        """Return to the bus, with an empty queue."""
        self.off, self.errors = False, 0
        self.queue.clear()


class Wire:
    """One bus.

    Args:
        bitrate: [bit/s].
        data_bitrate: of the data of CAN-FD frames [bit/s]; None for the same.
        damaged: whether a frame from a node is hit by an error; asked at each attempt.
        lost: whether a node misses a frame, though all is well on the bus.
    """

    def __init__(
        self,
        bitrate: float = 1e6,
        damaged: Callable[[Node, Frame], bool] | None = None,
        lost: Callable[[Node, Frame], bool] | None = None,
        data_bitrate: float | None = None,
    ) -> None:
        self._data_bitrate = data_bitrate or bitrate
        self.bitrate, self.damaged, self.lost = bitrate, damaged, lost
        self.nodes: list[Node] = []
        self.busy = 0.0  # seconds of bus time used
        self._free = 0.0  # when the bus falls idle
        self._under_way: tuple[float, Node, Frame, bool] | None = None

    def attach(self, name: str, receive: Receiver, echo: Receiver | None = None) -> Node:
        """Return a new node."""
        node = Node(name, receive, echo)
        self.nodes.append(node)
        return node

    def detach(self, node: Node) -> None:
        """Remove a node; a frame that it is sending is cut off."""
        self.nodes.remove(node)
        if self._under_way and self._under_way[1] is node:
            self._under_way = None

    def send(self, node: Node, frame: Frame, now: float) -> bool:
        """Queue a frame; return False if the queue is full or the node is off the bus."""
        if node.off or len(node.queue) >= QUEUE:
            return False
        node.queue.append((now, frame))
        return True

    def next_done(self) -> float | None:
        """Return when the next frame will be complete [s], if nothing else comes first."""
        if self._under_way:
            return self._under_way[0]
        winner = self._winner()
        if winner is None:
            return None
        start, node = winner
        return start + self._takes(node.queue[0][1])

    def advance(self, until: float) -> None:
        """Simulate everything that happens up to a time [s]."""
        while True:
            if self._under_way is None and not self._start(until):
                return
            assert self._under_way is not None
            end, node, frame, damaged = self._under_way
            if end > until:
                return
            self._under_way, self._free = None, end
            if damaged:
                self._hit(node)
            else:
                self._done(end, node, frame)

    def _winner(self) -> tuple[float, Node] | None:
        """When the next frame starts, and whose."""
        waiting = [node for node in self.nodes if node.queue]
        if not waiting:
            return None
        start = max(self._free, min(node.queue[0][0] for node in waiting))
        ready = [node for node in waiting if node.queue[0][0] <= start]
        return start, min(ready, key=lambda node: node.queue[0][1].priority)

    def _start(self, until: float) -> bool:
        winner = self._winner()
        if winner is None or winner[0] > until:
            return False
        start, node = winner
        frame = node.queue[0][1]
        # without another node nobody acknowledges
        damaged = len(self.nodes) < 2 or bool(self.damaged and self.damaged(node, frame))
        takes = self._takes(frame)
        takes = 0.5 * takes + _ERROR_BITS / self.bitrate if damaged else takes
        self.busy += takes
        self._under_way = (start + takes, node, frame, damaged)
        return True

    def _takes(self, frame: Frame) -> float:
        """How long a frame takes [s]."""
        return seconds(frame, self.bitrate, self._data_bitrate)

    def _hit(self, node: Node) -> None:
        if len(self.nodes) < 2 and node.errors > _WARN:
            return  # a missing acknowledge alone drives no node off the bus
        node.errors += 8
        if node.errors > _OFF:
            node.off = True
            node.queue.clear()

    def _done(self, end: float, node: Node, frame: Frame) -> None:
        if node.queue and node.queue[0][1] is frame:
            node.queue.popleft()
        node.errors = max(0, node.errors - 1)
        if node.echo:
            node.echo(end, frame)
        for other in list(self.nodes):
            if other is not node and not other.off and not (self.lost and self.lost(other, frame)):
                other.receive(end, frame)
