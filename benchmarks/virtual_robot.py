"""Configurations of virtual robots on buses between processes."""

from __future__ import annotations

from pathlib import Path

import tomli_w

LEGS = "fl", "fr", "rl", "rr"
_RANGES = {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "of the virtual drives"}
_AXES = {"abduction": (-12.0, 12.0), "hip": (-1.7, 1.7), "knee": (-1.4, 4.0)}


def four_legs(folder: Path, time_scale: float = 1.0, legs: int = 4, machine: str = "") -> Path:
    """Three drives a leg and a bus a leg, written to a folder; returns the file.

    Legs stand on their own; for policies of a machine they carry a trunk with an inertial unit.

    Args:
        folder: of the file and of the buses' sockets.
        time_scale: of the bench.
        legs: how many of the four.
        machine: hash of the machine that policies were trained for; empty for none.
    """
    motors = [
        {
            "axis": f"{leg}_{axis}", "bus": leg, "protocol": "damiao", "id": k + 1, "reply_id": 17 + k,
            "ranges": _RANGES,
            "limits": {"position": list(position), "velocity": 44.0, "torque": 24.0},
        }
        for leg in LEGS[:legs]
        for k, (axis, position) in enumerate(_AXES.items())
    ]  # fmt: skip
    buses = [
        {"name": leg, "interface": "workbench", "channel": str(folder / f"{leg}.sock")} for leg in LEGS[:legs]
    ]
    mechanisms = [{"model": "leg", "axes": [f"{leg}_hip", f"{leg}_knee"]} for leg in LEGS[:legs]]
    bench = {"time_scale": time_scale, "rig": "quadruped" if machine else "legs"}
    content = {"format": 1, "name": "legs", "machine": machine, "bench": bench, "bus": buses,
               "motor": motors, "mechanism": mechanisms}  # fmt: skip
    if machine:
        content["imu"] = {"bus": LEGS[0], "id": 0x60}
    path = folder / "robot.toml"
    path.write_text(tomli_w.dumps(content))
    return path
