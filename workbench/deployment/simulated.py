"""Buses and virtual motors in one process, in simulated time: a network without delays of its own."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from workbench.can import CanConfig, Frame, Wire
from workbench.rigs import MotorBank
from workbench.rigs.motor_bank import IMU

from .network import Arrival

_EPS = 1e-12


class SimulatedNetwork:
    """See `Network`; time advances only while somebody waits.

    Args:
        config: buses and motors.
        bank: the motors; None for a bank of the configuration.

    Attributes:
        bank: the motors.
        wires: the buses, for errors and losses.
        tamper: turns an arrival into what the host gets instead: pairs of when [s] and what.
        every_row: is called with the time of each row of the motors.
    """

    def __init__(self, config: CanConfig, bank: MotorBank | None = None) -> None:
        self.bank = bank or MotorBank(config)
        self.wires = {bus.name: Wire(bus.bitrate, data_bitrate=bus.data_bitrate) for bus in config.bus}
        self.tamper: Callable[[Arrival], list[tuple[float, Arrival]]] | None = None
        self.every_row: Callable[[float], None] | None = None
        self._motors = {
            motor.axis: (
                self.wires[motor.bus],
                self.wires[motor.bus].attach(motor.axis, partial(self._heard, motor.axis)),
            )
            for motor in config.motor
        }
        if config.imu:
            wire = self.wires[config.imu.bus]
            self._motors[IMU] = (wire, wire.attach("imu", lambda stamp, frame: None))
        self.hosts = {
            name: wire.attach("host", partial(self._arrived, name, False), partial(self._arrived, name, True))
            for name, wire in self.wires.items()
        }
        self._now, self._rows = 0.0, 0
        self._waiting: list[tuple[float, Arrival]] = []

    def now(self) -> float:
        """Return the simulated time [s]."""
        return self._now

    def sleep_until(self, time: float) -> None:
        """Simulate until a time."""
        while self._now < time - _EPS:
            self._step(time)

    def send(self, bus: str, frame: Frame) -> bool:
        """Queue a frame."""
        return self.wires[bus].send(self.hosts[bus], frame, self._now)

    def receive(self, until: float) -> list[Arrival]:
        """Return the received frames; simulate until there is one."""
        while True:
            ready = [a for when, a in self._waiting if when <= self._now + _EPS]
            if ready:
                self._waiting = [(w, a) for w, a in self._waiting if w > self._now + _EPS]
                return ready
            if self._now >= until - _EPS:
                self._now = max(self._now, until)
                return []
            self._step(until)

    def ok(self, bus: str) -> bool:
        """Return whether a bus carries frames."""
        return not self.hosts[bus].off

    def flush(self, bus: str) -> None:
        """Discard queued frames."""
        self.hosts[bus].queue.clear()

    def restart(self, bus: str) -> None:
        """Restart a bus that was off."""
        if self.hosts[bus].off:
            self.hosts[bus].come_back()

    def _step(self, until: float) -> None:
        """On to the next event, or to `until`."""
        row = self._rows * self.bank.row
        events = [done for wire in self.wires.values() if (done := wire.next_done()) is not None]
        events += [when for when, _ in self._waiting if when > self._now]
        time = max(self._now, min([until, row, *events]))
        for wire in self.wires.values():
            wire.advance(time)
        self._now = time
        if time >= row - _EPS:
            self._rows += 1
            for axis, frame in self.bank.work(time):
                wire, node = self._motors[axis]
                wire.send(node, frame, time)
            if self.every_row:
                self.every_row(time)

    def _heard(self, axis: str, stamp: float, frame: Frame) -> None:
        self.bank.motors[axis].hear(frame)

    def _arrived(self, bus: str, sent: bool, stamp: float, frame: Frame) -> None:
        arrival = Arrival(bus, stamp, frame, sent)
        self._waiting += self.tamper(arrival) if self.tamper else [(stamp, arrival)]
