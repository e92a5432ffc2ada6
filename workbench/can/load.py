"""How full each bus can get: every frame as long as stuffing can make it."""

from __future__ import annotations

from dataclasses import dataclass

from .frame import worst_bits
from .imu import IMUS
from .tables import CanConfig, make_drive

MOST = 0.7  # of a bus; the rest is for errors, parameters and frames that come late


@dataclass(frozen=True)
class BusLoad:
    """What a bus carries at worst.

    Attributes:
        bus: its name.
        motors: how many drives are on it.
        frames: a second.
        bits: a second, stuffing and intermission included.
        share: of its bit rate.
    """

    bus: str
    motors: int
    frames: float
    bits: float
    share: float

    @property
    def fits(self) -> bool:
        """Whether the share is at most `MOST`."""
        return self.share <= MOST


def bus_load(config: CanConfig) -> list[BusLoad]:
    """The load of every bus, each motor commanded and answering in every exchange."""
    loads, rate = [], config.loop.polls / config.loop.period_s
    for bus in config.bus:
        bits = 0
        for motor in config.on(bus.name):
            drive = make_drive(motor)
            bits += worst_bits(8, drive.extended) + worst_bits(drive.length, drive.extended)
        count = len(config.on(bus.name))
        frames, second = 2 * count * rate, bits * rate
        if config.imu and config.imu.bus == bus.name:
            lengths = IMUS[config.imu.protocol](config.imu.id).lengths
            frames += len(lengths) / config.imu.period_s
            second += sum(worst_bits(length) for length in lengths) / config.imu.period_s
        loads.append(BusLoad(bus.name, count, frames, second, second / bus.bitrate))
    return loads
