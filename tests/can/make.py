"""Configurations to test with."""

from __future__ import annotations

from pathlib import Path

import tomli_w

from workbench.can import CanConfig, load_config

RANGES = {"position": 12.5, "velocity": 30.0, "torque": 25.0, "source": "a manual"}
LIMITS = {"position": [-3.0, 3.0], "velocity": 25.0, "torque": 20.0}


def motor(axis: str, id: int, bus: str = "can0", protocol: str = "damiao", **more: object) -> dict:
    """One motor's table; ids of answers are the id's plus 16."""
    reply = 0xFD if protocol == "robstride" else id + 0x10
    table = {"axis": axis, "bus": bus, "protocol": protocol, "id": id, "reply_id": reply,
             "ranges": RANGES, "limits": LIMITS}  # fmt: skip
    if protocol == "mit":
        table["watchdog_source"] = "set with the vendor's tool"
    return {**table, **more}


def table(motors: list[dict], buses: tuple[str, ...] = ("can0",), **more: object) -> dict:
    """A whole configuration's table."""
    bus = [{"name": name, "interface": "workbench", "channel": f"{name}.sock"} for name in buses]
    return {"format": 1, "name": "test", "bus": bus, "motor": motors, **more}


def written(folder: Path, content: dict) -> Path:
    """The configuration as a file."""
    path = folder / "robot.toml"
    path.write_text(tomli_w.dumps(content))
    return path


def config(folder: Path, motors: list[dict], buses: tuple[str, ...] = ("can0",), **more: object) -> CanConfig:
    """A configuration, read."""
    return load_config(written(folder, table(motors, buses, **more)))
