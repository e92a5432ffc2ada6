"""What a drive says of itself before it moves, in words with units."""

from __future__ import annotations

from workbench.deployment.verify import Verified


def test_what_a_drive_says_has_units() -> None:
    told = {"mode": 1.0, "watchdog": 0.02, "position": 12.5, "velocity": 45.0, "torque": 25.0}
    said = "hip answers: watchdog 20 ms, position ±12.5 rad, velocity ±45 rad/s, torque ±25 N m"
    assert Verified("hip", told, "").line == said


def test_what_cannot_be_read_is_said_with_its_source() -> None:
    line = Verified("hip", {}, "mode, torque, watchdog as stated by the data sheet").line
    assert line == "hip answers; not read: mode, torque, watchdog as stated by the data sheet"
