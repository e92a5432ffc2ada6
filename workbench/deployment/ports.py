"""Buses by python-can, on the clock of their configuration."""

from __future__ import annotations

import select
import time
from collections import deque

import can

from workbench.can import CanConfig, Frame
from workbench.can.messages_of_can import from_message, to_message
from workbench.can.plugin import WorkbenchBus
from workbench.can.tables import BusTable
from workbench.core import InputError

from .network import Arrival

_BUS_OFF = 0x40  # class of a SocketCAN error frame
_LATE = 1.0  # a stamp further back than this is from another clock [s]
_OWN = 256  # frames of ours that may be on their way back, where an interface does not tell them
#: A process that only listens hears there what another one of the same computer sends.
_SHARED = ("workbench", "socketcan", "udp_multicast")


class PortNetwork:
    """See `Network`.

    Args:
        config: the buses.
        echo: own frames come back when they are complete on the wire, where the interface can; where it
            brings them back as if they were another's (udp_multicast), they are told by their content.

    Raises:
        InputError: a bus cannot be opened.
    """

    def __init__(self, config: CanConfig, echo: bool = True) -> None:
        self._buses: dict[str, can.BusABC] = {}
        self._off: set[str] = set()
        self._refused: dict[str, int] = {}
        self._own: dict[str, deque[Frame]] = {}
        self._clock = config.clock
        try:
            for bus in config.bus:
                self._buses[bus.name], told = open_bus(bus, config, echo)
                if echo and not told:
                    self._own[bus.name] = deque(maxlen=_OWN)
        except InputError:
            self.close()
            raise
        numbers = {name: _fileno(bus) for name, bus in self._buses.items()}
        self._names = {number: name for name, number in numbers.items() if number is not None}
        self._selectable = len(self._names) == len(numbers)

    def now(self) -> float:
        """Return the monotonic time [s]."""
        return self._clock.now()

    def sleep_until(self, time: float) -> None:
        """Return at a time [s]."""
        self._clock.sleep_until(time)

    def send(self, bus: str, frame: Frame) -> bool:
        """Queue a frame; never wait."""
        try:
            self._buses[bus].send(to_message(frame), timeout=0.0)
        except (can.CanError, OSError):
            return False
        if bus in self._own:
            self._own[bus].append(frame)
        return True

    def receive(self, until: float) -> list[Arrival]:
        """Return the received frames; wait for the first."""
        arrivals: list[Arrival] = []
        while not arrivals:
            wait = self._clock.machine(max(0.0, until - self._clock.now()))
            if self._selectable:
                names = [self._names[f] for f in select.select(list(self._names), [], [], wait)[0]]
            else:
                names = list(self._buses)
                time.sleep(min(wait, 2e-4))
            for name in names:
                self._drain(name, arrivals)
            if wait == 0.0:
                break
        return arrivals

    def ok(self, bus: str) -> bool:
        """Return whether a bus carries frames and has accepted all frames since the last call."""
        port = self._buses[bus]
        if isinstance(port, WorkbenchBus):
            before, self._refused[bus] = self._refused.get(bus, 0), port.refused
            if port.refused != before or port.off:
                return False
        return bus not in self._off

    def flush(self, bus: str) -> None:
        """Discard queued frames, if the interface can."""
        try:
            self._buses[bus].flush_tx_buffer()
        except (NotImplementedError, can.CanError, OSError):
            return

    def restart(self, bus: str) -> None:
        """Restart a bus that was off; on SocketCAN the ``restart-ms`` of the kernel does it."""
        self._off.discard(bus)
        port = self._buses[bus]
        if isinstance(port, WorkbenchBus) and port.off:
            port.come_back()

    @property
    def gone(self) -> bool:
        """Return whether no bus is left."""
        return self._off >= set(self._buses)

    def close(self) -> None:
        """Leave every bus."""
        for bus in self._buses.values():
            bus.shutdown()

    def _drain(self, name: str, arrivals: list[Arrival]) -> None:
        port = self._buses[name]
        while True:
            try:
                message = port.recv(0.0)
            except (can.CanError, OSError):
                self._off.add(name)
                if self._selectable:
                    self._names = {f: n for f, n in self._names.items() if n != name}
                return
            if message is None:
                return
            if message.is_error_frame:
                if message.arbitration_id & _BUS_OFF:
                    self._off.add(name)
                continue
            frame = from_message(message)
            sent = not message.is_rx or self._came_back(name, frame)
            arrivals.append(Arrival(name, self._stamp(port, message), frame, sent))

    def _came_back(self, name: str, frame: Frame) -> bool:
        """Whether a frame is one of ours, on a bus that does not say so; they come back in their order."""
        own = self._own.get(name)
        if not own or frame not in own:
            return False
        while own.popleft() != frame:
            pass
        return True

    def _stamp(self, port: can.BusABC, message: can.Message) -> float:
        if isinstance(port, WorkbenchBus):
            return port.monotonic(message.timestamp)
        return monotonic_stamp(message.timestamp, time.time(), time.monotonic())


def monotonic_stamp(timestamp: float, wall: float, monotonic: float) -> float:
    """Return a wall clock stamp on the monotonic clock [s].

    Args:
        timestamp: of the frame, wall clock [s].
        wall, monotonic: both clocks now.

    Returns:
        How long ago it was, taken from now; now itself where that makes no sense, as after a jump of the
        wall clock, or where the interface stamps with another clock.
    """
    age = wall - timestamp
    return monotonic - age if 0.0 <= age <= _LATE else monotonic


def open_bus(bus: BusTable, config: CanConfig, echo: bool = True) -> tuple[can.BusABC, bool]:
    """Return an open bus, and whether it distinguishes own frames from those of others.

    Raises:
        InputError: it cannot be opened.
    """
    where = {"file": config.source, "column": f"bus.{bus.name}"}

    flexible = {}
    if bus.data_bitrate:
        flexible = {"fd": True, "data_bitrate": bus.data_bitrate}
        if bus.interface == "virtual":  # has another name for it
            flexible = {"protocol": can.CanProtocol.CAN_FD}

    def opened(echo: bool) -> can.BusABC:
        return can.Bus(
            interface=bus.interface, channel=bus.channel, bitrate=bus.bitrate, receive_own_messages=echo,
            **flexible, **bus.options,
        )  # fmt: skip

    try:
        if bus.interface == "workbench":  # also where the package's entry points are not installed
            port = WorkbenchBus(
                bus.channel, receive_own_messages=echo, time_scale=config.bench.time_scale, **bus.options
            )
            return port, echo
        try:
            return opened(echo), echo
        except NotImplementedError:  # no such interface, or one without echo
            return opened(False), False
    except (can.CanError, OSError, ValueError, ImportError, NotImplementedError) as error:
        remedy = (
            "start it with 'workbench can virtual'" if bus.interface == "workbench" else "check interface"
        )
        raise InputError(f"cannot be opened: {error}", **where, remedy=remedy) from error


def refuse_unheard(config: CanConfig) -> None:
    """Refuse buses that only one process can use, because the logger of an experiment needs them too.

    Raises:
        InputError: such a bus.
    """
    if bus := unheard(config):
        raise InputError(
            f"{bus.interface} serves one process at a time, and the frames are logged by another",
            file=config.source, column=f"bus.{bus.name}.interface",
            remedy="use the adapter by its SocketCAN driver (slcand makes one of a serial adapter)",
        )  # fmt: skip


def unheard(config: CanConfig) -> BusTable | None:
    """Return the first bus that only one process can use; None if there is none."""
    return next((bus for bus in config.bus if bus.interface not in _SHARED), None)


def _fileno(bus: can.BusABC) -> int | None:
    try:
        number = bus.fileno()
    except NotImplementedError:
        return None
    return number if number >= 0 else None
