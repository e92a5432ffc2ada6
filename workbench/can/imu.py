"""Inertial units on a bus: angular velocity, direction of gravity and, if available, the specific force.

A unit of another make is one more class with these three members, under its name in `IMUS`; what it measures
in other quantities (a quaternion, an acceleration) it turns into these itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol

from .frame import Frame, FrameError
from .span import Span

#: x, y and z in the base's frame.
Triple = tuple[float, float, float]
Quantity = Literal["angular", "gravity", "force"]


class Imu(Protocol):
    """Interface of a unit for the host and the bus load.

    Attributes:
        lengths: bytes of each frame of one sample.
        ids: standard identifiers that it sends on.
        tells: the quantities of one sample; without ``force`` a fall without tilt is not seen.
    """

    lengths: tuple[int, ...]
    ids: tuple[int, ...]
    tells: tuple[Quantity, ...]

    def decode(self, frame: Frame) -> tuple[Quantity, Triple] | None:
        """Return angular velocity [rad/s], direction of gravity (unit vector), or force divided by weight.

        What an accelerometer shows is that force: as long as the weight, and up, at rest; zero in free fall.
        None where it is not its frame.

        Raises:
            FrameError: its identifier, and nothing that it sends.
        """
        ...


class WorkbenchImu:
    """The virtual unit: angular velocity, direction of gravity, force by weight; 16 bits each, big-endian.

    Args:
        id: of the first of its three frames, which follow each other.
    """

    lengths: tuple[int, ...] = (6, 6, 6)
    tells: tuple[Quantity, ...] = ("angular", "gravity", "force")
    spans: tuple[tuple[Quantity, Span], ...] = (
        ("angular", Span(-35.0, 35.0, 16)), ("gravity", Span(-1.2, 1.2, 16)),
        ("force", Span(-16.0, 16.0, 16)),
    )  # fmt: skip

    def __init__(self, id: int) -> None:
        if not 0 <= id < 0x7FE:
            raise FrameError(f"id {id:#x} is outside 0x0 to 0x7fd")
        self.ids: tuple[int, ...] = (id, id + 1, id + 2)

    def encode(self, angular: Triple, gravity: Triple, force: Triple) -> list[Frame]:
        """Return the frames of one sample; values beyond the range are clipped."""
        frames = []
        for id, values, (_, span) in zip(self.ids, (angular, gravity, force), self.spans, strict=True):
            raw = [span.encode(min(max(value, span.low), span.high)) for value in values]
            frames.append(Frame(id, b"".join(each.to_bytes(2, "big") for each in raw)))
        return frames

    def decode(self, frame: Frame) -> tuple[Quantity, Triple] | None:
        """See `Imu`."""
        if frame.extended or frame.id not in self.ids:
            return None
        if len(frame.data) != 6:
            raise FrameError(f"{len(frame.data)} bytes are not a sample")
        quantity, span = self.spans[frame.id - self.ids[0]]
        x, y, z = (span.decode(int.from_bytes(frame.data[k : k + 2], "big")) for k in (0, 2, 4))
        if quantity == "gravity" and not 0.8 < x * x + y * y + z * z < 1.2:
            raise FrameError("gravity has no direction: its length is not 1")
        return quantity, (x, y, z)


#: Name in a configuration -> the unit with this identifier.
IMUS: dict[str, Callable[[int], Imu]] = {"workbench": WorkbenchImu}
