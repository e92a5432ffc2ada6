"""python-can interface ``workbench``: a node on the bus between processes."""

from __future__ import annotations

import select
import socket
import time
from typing import Any

import can
from can.exceptions import CanInitializationError, CanOperationError

from .clock import Clock
from .messages_of_can import from_message, to_message
from .packets import SIZE, pack, unpack


class WorkbenchBus(can.BusABC):
    """A node; see `workbench.can.server`.

    Time stamps are those of the wire's model on the monotonic clock, shifted by one constant to look like
    wall clock time: they never jump. `monotonic` takes the constant off again.

    Args:
        channel: path of the bus's socket.
        receive_own_messages: echo own frames when they are complete on the wire.
        time_scale: of the bench (see `Clock`), on whose clock stamps are.

    Raises:
        CanInitializationError: nobody serves the bus.
    """

    def __init__(
        self, channel: str, receive_own_messages: bool = False, time_scale: float = 1.0, **kwargs: Any
    ) -> None:  # fmt: skip
        self._can_protocol = can.CanProtocol.CAN_FD
        self.channel_info = f"workbench bus {channel}"
        self._off, self._refused = False, 0
        self.shift = time.time() - Clock(time_scale).now()
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            self._socket.connect(str(channel))
        except OSError as error:
            self._socket.close()
            raise CanInitializationError(f"no bus at {channel}: {error.strerror}") from error
        self._socket.setblocking(False)
        if not receive_own_messages:
            self._packet(pack(b"Q"))
        kwargs.pop("bitrate", None)
        super().__init__(channel=channel, **kwargs)

    @property
    def off(self) -> bool:
        """Return whether the node is off the bus."""
        return self._off

    @property
    def refused(self) -> int:
        """Return the number of frames that were not sent because the queue was full or the node was off."""
        return self._refused

    def come_back(self) -> None:
        """Return to the bus after the node was off; queued frames are lost."""
        self._packet(pack(b"B"))
        self._off = False

    def monotonic(self, timestamp: float) -> float:
        """Return the monotonic time [s] of the time stamp of a message."""
        return timestamp - self.shift

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Queue a frame.

        Raises:
            CanOperationError: the node is off the bus, or the bus is gone.
        """
        if self._off:
            raise CanOperationError("off the bus")
        frame = from_message(msg)
        self._packet(pack(b"S", 0.0, frame))

    def fileno(self) -> int:
        """Return the file descriptor for `select`."""
        return self._socket.fileno()

    def shutdown(self) -> None:
        """Leave the bus."""
        super().shutdown()
        self._socket.close()

    def _packet(self, packet: bytes) -> None:
        try:
            self._socket.send(packet)
        except BlockingIOError as error:
            raise CanOperationError("transmit queue full") from error
        except OSError as error:
            raise CanOperationError(f"the bus is gone: {error.strerror}") from error

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            try:
                packet = self._socket.recv(SIZE + 1)
            except BlockingIOError:
                wait = None if end is None else end - time.monotonic()
                if wait is not None and wait <= 0.0:
                    return None, False
                select.select([self._socket], [], [], wait)
                continue
            except OSError as error:
                raise CanOperationError(f"the bus is gone: {error.strerror}") from error
            if not packet:
                raise CanOperationError("the bus is gone")
            message = self._message(packet)
            if message is not None:
                return message, False

    def _message(self, packet: bytes) -> can.Message | None:
        kind, stamp, frame = unpack(packet)
        if kind in (b"O", b"F"):
            self._off |= kind == b"O"
            self._refused += 1
            return None
        told = {"timestamp": stamp + self.shift, "is_rx": kind == b"R", "channel": self.channel_info}
        return to_message(frame, **told)
