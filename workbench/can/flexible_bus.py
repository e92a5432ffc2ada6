"""What CAN-FD, moteus and ODrive drives require of a configuration."""

from __future__ import annotations

from collections.abc import Iterator

from .tables import CanConfig


def flexible_problems(c: CanConfig) -> Iterator[tuple[str, str, str]]:
    """Return key, problem and remedy of everything that is wrong."""
    for bus in c.bus:
        key, own = f"bus '{bus.name}'", {motor.protocol for motor in c.on(bus.name)}
        if bus.data_bitrate and bus.data_bitrate < bus.bitrate:
            problem = f"{bus.data_bitrate} is slower than the arbitration rate {bus.bitrate}"
            yield f"{key}.data_bitrate", problem, "correct one of them"
        if "moteus" not in own:
            continue
        if not bus.data_bitrate:
            problem = "moteus drives speak CAN-FD"
            yield f"{key}.data_bitrate", problem, "give the rate of its data, as 5_000_000"
        if others := own - {"moteus"}:
            problem = f"{', '.join(sorted(others))} drives treat CAN-FD frames as errors"
            yield f"{key}.data_bitrate", problem, "put moteus drives on a bus of their own"
    kds = dict(zip(c.axes, c.gains()[1], strict=False))
    for motor in c.motor:
        key, kd = f"motor '{motor.axis}'", motor.ranges.kd
        if motor.protocol == "odrive" and c.loop.pd == "drive" and kds.get(motor.axis, 1.0) <= 0.0:
            yield "loop.kd", f"'{motor.axis}' has no stiffness without damping", "give more than 0"
        if motor.protocol != "moteus":
            continue
        if c.loop.pd == "drive":
            problem = (
                f"'{motor.axis}' cannot use a larger share of its range for kd than for kp, because kp "
                "fades in"
            )
            yield "loop.pd", problem, 'write pd = "host"'
        if c.loop.damping != kd:
            problem = f"a moteus damps with its whole kd of {kd:g}, not with {c.loop.damping:g}"
            yield f"{key}.ranges.kd", problem, "make loop.damping, ranges.kd and the drive's own the same"
