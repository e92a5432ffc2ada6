"""The bus between processes: carries frames between sockets as a wire would, in real time."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import stat
from collections.abc import Callable
from functools import partial
from pathlib import Path

from workbench.core import InputError

from .frame import Frame
from .packets import SIZE, pack, unpack
from .tables import CanConfig
from .wire import Node, Wire

_LONGEST = 0.05  # s without looking whether to stop


class BusServer:
    """One bus on one AF_UNIX socket; every connection is a node.

    Sockets keep packets whole. A node that does not read loses frames, and holds up nobody.

    Args:
        channel: path of the socket.
        wire: the model of the bus.

    Raises:
        InputError: the path is taken or cannot be made.
    """

    def __init__(self, channel: str | Path, wire: Wire) -> None:
        self.wire, self._path = wire, Path(channel)
        self._nodes: dict[socket.socket, Node] = {}
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET | socket.SOCK_NONBLOCK)
        try:
            if self._path.exists() and stat.S_ISSOCK(os.stat(self._path).st_mode):
                _refuse_living(self._path)
                self._path.unlink()
            self._listener.bind(str(self._path))
        except OSError as error:
            raise InputError(
                f"no bus can be made: {error.strerror or error}", file=self._path, column="bus.channel",
                remedy="choose a short path in a folder that exists",
            ) from error  # fmt: skip
        self._listener.listen(64)

    @property
    def sockets(self) -> list[socket.socket]:
        """Return all sockets to wait for."""
        return [self._listener, *self._nodes]

    def serve(self, ready: set[socket.socket], now: float) -> None:
        """Process what came in, then what the wire did until `now` [s]."""
        if self._listener in ready:
            self._accept()
        for connection in [c for c in self._nodes if c in ready]:
            self._read(connection, now)
        off = {node for node in self.wire.nodes if node.off}
        self.wire.advance(now)
        for connection, node in list(self._nodes.items()):
            if node.off and node not in off:
                self._tell(connection, pack(b"O", now))

    def close(self) -> None:
        """Close every connection and remove the socket."""
        for connection in [self._listener, *self._nodes]:
            connection.close()
        self._path.unlink(missing_ok=True)

    def _accept(self) -> None:
        with contextlib.suppress(BlockingIOError):
            connection, _ = self._listener.accept()
            connection.setblocking(False)

            def tell(kind: bytes, stamp: float, frame: Frame) -> None:
                self._tell(connection, pack(kind, stamp, frame))

            self._nodes[connection] = self.wire.attach("node", partial(tell, b"R"), partial(tell, b"E"))

    def _read(self, connection: socket.socket, now: float) -> None:
        node = self._nodes[connection]
        while True:
            try:
                packet = connection.recv(SIZE + 1)
                kind, _, frame = unpack(packet) if packet else (b"", 0.0, None)
            except BlockingIOError:
                return
            except ValueError:
                continue
            except OSError:
                kind, frame = b"", None
            if not kind:
                self._drop(connection)
                return
            if kind == b"Q":
                node.echo = None
            elif kind == b"B" and node.off:
                node.come_back()
            elif kind == b"S" and frame is not None and not self.wire.send(node, frame, now):
                self._tell(connection, pack(b"O" if node.off else b"F", now, frame))

    def _tell(self, connection: socket.socket, packet: bytes) -> None:
        try:
            connection.send(packet)
        except BlockingIOError:
            pass  # it does not read: its loss
        except OSError:
            self._drop(connection)

    def _drop(self, connection: socket.socket) -> None:
        node = self._nodes.pop(connection, None)
        if node is not None:
            self.wire.detach(node)
        connection.close()


def serve(
    config: CanConfig, stop: Callable[[], bool] = lambda: False, ready: Callable[[], None] = lambda: None
) -> None:
    """Run every bus of a configuration with ``interface = "workbench"`` until `stop` returns True.

    Args:
        config: the buses.
        stop: asked now and then.
        ready: called when nodes can connect.

    Raises:
        InputError: none of the buses is of this kind, or a path is taken.
    """
    own = [bus for bus in config.bus if bus.interface == "workbench"]
    if not own:
        raise InputError("no bus between processes", file=config.source, column="bus.interface",
                         remedy='write interface = "workbench"')  # fmt: skip
    servers: list[BusServer] = []
    clock = config.clock
    try:
        servers += [BusServer(bus.channel, Wire(bus.bitrate, data_bitrate=bus.data_bitrate)) for bus in own]
        ready()
        while not stop():
            now = clock.now()
            done = [d for server in servers if (d := server.wire.next_done()) is not None]
            wait = min([_LONGEST, *(clock.machine(max(0.0, d - now)) for d in done)])
            sockets = [s for server in servers for s in server.sockets]
            readable = set(select.select(sockets, [], [], wait)[0])
            now = clock.now()
            for server in servers:
                server.serve(readable, now)
    finally:
        for server in servers:
            server.close()


def _refuse_living(path: Path) -> None:
    """A socket that nobody serves any more may be replaced.

    Raises:
        OSError: somebody serves it.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as probe:
        try:
            probe.connect(str(path))
        except (ConnectionRefusedError, FileNotFoundError):
            return
    raise OSError(98, "another process serves this bus")
