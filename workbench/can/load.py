"""The largest load of each bus: every frame with as many stuff bits as possible."""

from __future__ import annotations

from dataclasses import dataclass

from .flexible import worst_seconds
from .imu import IMUS
from .messages import Carried
from .tables import CanConfig, make_drive

MOST = 0.7  # of a bus; the rest is for errors, parameters and frames that come late


@dataclass(frozen=True)
class BusLoad:
    """The largest load of a bus.

    Attributes:
        bus: its name.
        motors: how many drives are on it.
        frames: a second.
        bits: a second, stuffing and intermission included; as long as so many at the slower rate.
        share: of its bit rate.
    """

    bus: str
    motors: int
    frames: float
    bits: float
    share: float

    @property
    def fits(self) -> bool:
        """Return whether the load is at most `MOST`."""
        return self.share <= MOST


def bus_load(config: CanConfig) -> list[BusLoad]:
    """Return the load of every bus, if each motor is commanded and answers in every exchange."""
    loads, rate = [], config.loop.polls / config.loop.period_s
    for bus in config.bus:
        motors = config.on(bus.name)
        carried = [frame for motor in motors for frame in make_drive(motor).exchange]
        if config.imu and config.imu.bus == bus.name:
            lengths = IMUS[config.imu.protocol](config.imu.id).lengths
            carried += [Carried(length, hz=1.0 / config.imu.period_s) for length in lengths]
        frames = share = 0.0
        for length, extended, fd, hz in carried:
            frames += hz or rate
            takes = worst_seconds(length, extended, fd, bus.bitrate, bus.data_bitrate or bus.bitrate)
            share += takes * (hz or rate)
        loads.append(BusLoad(bus.name, len(motors), frames, share * bus.bitrate, share))
    return loads
