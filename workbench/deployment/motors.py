"""Virtual motors as a process: they read their buses and run row by row on the clock of the bench."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from workbench.can import CanConfig
from workbench.rigs import MotorBank
from workbench.rigs.motor_bank import IMU

from .network import Arrival
from .ports import PortNetwork

_ALONE = 0.2  # s without any bus, time for every watchdog
_BEHIND = 0.05  # s; a process that was held up longer does not catch up


def run_motors(
    config: CanConfig,
    bank: MotorBank,
    stop: Callable[[], bool] = lambda: False,
    ready: Callable[[], None] = lambda: None,
) -> None:
    """Run the motors on the buses of a configuration until `stop` returns True, or the bus is gone.

    Rows are worked in the order of their times, and no row hears what came later: one that is worked late
    does what it would have done in time, so that a process that was held up lets no watchdog run out.

    Args:
        config: the buses.
        bank: motors and machines.
        stop: asked once per row.
        ready: called when they hear.
    """
    network, waiting = PortNetwork(config, echo=False), deque[Arrival]()
    bus = {motor.axis: motor.bus for motor in config.motor}
    bus |= {IMU: config.imu.bus} if config.imu else {}
    hearers = {b.name: [bank.motors[m.axis] for m in config.on(b.name)] for b in config.bus}

    def hear(until: float) -> None:
        """What was complete on the wire by then."""
        while waiting and waiting[0].stamp <= until:
            arrival = waiting.popleft()
            for motor in hearers[arrival.bus]:
                motor.hear(arrival.frame)

    ready()
    row = heard = network.now()
    try:
        while not stop() and row - heard < _ALONE:
            came = [a for a in network.receive(row) if not a.sent]
            if came:
                waiting = deque(sorted([*waiting, *came], key=lambda a: a.stamp))
            now = network.now()
            if now < row:
                hear(now)
                said = bank.respond(now)
            else:
                row = now if now - row > _BEHIND else row
                hear(row)
                said = bank.work(row)
                row += bank.row
                heard = heard if network.gone else row
            for axis, frame in said:
                network.send(bus[axis], frame)
    finally:
        network.close()
