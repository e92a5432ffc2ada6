"""Virtual motors as a process: they hear their buses and work row by row, in real time."""

from __future__ import annotations

import time
from collections.abc import Callable

from workbench.can import CanConfig
from workbench.rigs import MotorBank

from .ports import PortNetwork

_ALONE = 0.2  # s without any bus, time for every watchdog
_BEHIND = 0.05  # s; a process that was held up longer does not catch up


def run_motors(
    config: CanConfig,
    bank: MotorBank,
    stop: Callable[[], bool] = lambda: False,
    ready: Callable[[], None] = lambda: None,
) -> None:
    """Works the motors of a bank on the buses of a configuration until `stop` says so, or the bus is gone.

    Args:
        config: the buses.
        bank: motors and machines.
        stop: asked once a row.
        ready: called when they hear.
    """
    network = PortNetwork(config, echo=False)
    bus = {motor.axis: motor.bus for motor in config.motor}
    hearers = {b.name: [bank.motors[m.axis] for m in config.on(b.name)] for b in config.bus}
    ready()
    row = heard = time.monotonic()
    try:
        while not stop() and row - heard < _ALONE:
            for arrival in network.receive(row):
                for motor in hearers[arrival.bus]:
                    if not arrival.sent:
                        motor.hear(arrival.frame)
            now = time.monotonic()
            if now < row:
                for axis, frame in bank.respond(now):
                    network.send(bus[axis], frame)
                continue
            row = now if now - row > _BEHIND else row
            for axis, frame in bank.work(row):
                network.send(bus[axis], frame)
            row += bank.row
            heard = heard if network.gone else row
    finally:
        network.close()
