"""One host per bus: two hosts would command the same drives, and each would take all answers for its own."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from hashlib import sha256
from pathlib import Path

from workbench.can import CanConfig
from workbench.can.tables import BusTable
from workbench.core import InputError

from .ports import PortNetwork


@contextmanager
def alone(config: CanConfig) -> Iterator[None]:
    """Prevent other processes of this computer from commanding the buses of a configuration.

    The lock is the kernel's and goes with the process, however it ends.

    Raises:
        InputError: another process commands one of them.
    """
    with ExitStack() as held:
        for bus in config.bus:
            held.enter_context(_lock(bus, config))
        yield


@contextmanager
def opened(config: CanConfig) -> Iterator[PortNetwork]:
    """Open the buses of a configuration for the only host that commands them.

    Raises:
        InputError: a bus cannot be opened, or another process commands it.
    """
    with alone(config):
        network = PortNetwork(config)
        try:
            yield network
        finally:
            network.close()


@contextmanager
def _lock(bus: BusTable, config: CanConfig) -> Iterator[None]:
    # a socket's path is the same bus by whichever name it is reached; a device's name is no path
    channel = os.path.realpath(bus.channel) if "/" in bus.channel else bus.channel
    name = sha256(f"{bus.interface} {channel}".encode()).hexdigest()[:16]
    path = Path(tempfile.gettempdir()) / f"workbench-bus-{name}.lock"
    try:
        file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    except OSError as error:
        remedy = "check who owns that file"
        raise InputError(f"cannot be opened ({error.strerror})", file=path, remedy=remedy) from error
    try:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise InputError(
                "is commanded by another process", file=config.source, column=f"bus.{bus.name}",
                remedy="end that one first",
            ) from error  # fmt: skip
        yield
    finally:
        os.close(file)
