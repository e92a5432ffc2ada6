"""Logs that `import` and recordings read: CAN, MCAP, ROS 2 bags, LeRobot."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomli_w

from .tables import AXES, ROWS, description, table

_START_NS = 1_750_000_000 * 10**9


def can_log(folder: Path, ending: str) -> None:
    """A log of two drives' feedback, its DBC, and the recording that names them."""
    import can

    from workbench.can import Damiao, Feedback, Ranges, dbc

    ranges = Ranges(12.5, 45.0, 25.0, 500.0, 5.0, "label")
    drives = {axis: Damiao(i + 1, 17 + i, ranges) for i, axis in enumerate(AXES)}
    data = table()
    with can.Logger(folder / f"run{ending}") as log:
        for k, t in enumerate(data["t"]):
            for i, (axis, drive) in enumerate(drives.items()):
                seen = Feedback(
                    data[f"q_{axis}"][k], data[f"w_{axis}"][k], data[f"tau_{axis}"][k], 30.0, True
                )
                frame = drive.answer(seen)
                stamp = 1e9 + float(t) + 4e-4 * i
                log(can.Message(stamp, frame.id, False, data=frame.data, channel=0, is_rx=True))
    (folder / "run.dbc").write_text(dbc(drives))
    names = {"position": "position", "velocity": "velocity", "torque_measured": "torque"}
    content = {**description(f"run{ending}"), "excitation": {"kind": "random"}}
    content["columns"] = {
        "time": "t", "valid": "valid", **{s: [f"{n}_{axis}" for axis in AXES] for s, n in names.items()},
    }  # fmt: skip
    (folder / "run.toml").write_text(tomli_w.dumps(content))


#: Of ROS 2's sensor_msgs/msg/JointState with all that it is made of, as MCAP files hold it.
JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def _states() -> Iterator[tuple[int, list[list[float]]]]:
    """Time [ns], and position, velocity and torque of the joints, row by row."""
    data = table()
    for k, t in enumerate(data["t"][:80]):
        yield (
            _START_NS + round(t * 1e9),
            [[float(data[f"{n}_{a}"][k]) for a in AXES] for n in ("q", "w", "tau")],
        )


def mcap(folder: Path) -> None:
    """One MCAP file with ROS 2 messages and one with JSON."""
    from mcap.writer import CompressionType
    from mcap.writer import Writer as JsonWriter
    from mcap_ros2.writer import Writer

    with (folder / "ros.mcap").open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for ns, (q, w, tau) in _states():
            stamp = {"sec": ns // 10**9, "nanosec": ns % 10**9}
            message = {"header": {"stamp": stamp, "frame_id": ""}, "name": list(AXES)}
            message |= {"position": q, "velocity": w, "effort": tau}
            writer.write_message("/joint_states", schema, message, log_time=ns, publish_time=ns)
        writer.finish()
    with (folder / "json.mcap").open("wb") as file:
        plain = JsonWriter(file)
        plain.start()
        channel = plain.register_channel("/leg", "json", plain.register_schema("state", "jsonschema", b"{}"))
        for ns, (q, w, tau) in _states():
            plain.add_message(channel, ns, json.dumps({"q": q, "dq": w, "tau": tau}).encode(), ns)
        plain.finish()


def bag(folder: Path) -> None:
    """A ROS 2 bag in SQLite."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kind: Any = store.types
    state, header = kind["sensor_msgs/msg/JointState"], kind["std_msgs/msg/Header"]
    time = kind["builtin_interfaces/msg/Time"]
    with Writer(folder / "bag", version=9) as writer:
        states = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for ns, values in _states():
            message = state(header(time(ns // 10**9, ns % 10**9), ""), list(AXES), *map(np.array, values))
            writer.write(states, ns, store.serialize_cdr(message, state.__msgtype__))


def lerobot(folder: Path) -> None:
    """A LeRobot data set of one episode."""
    data = table()
    names = [f"{axis}.pos" for axis in AXES]
    features = {
        n: {"dtype": "float32", "shape": [2], "names": names} for n in ("observation.state", "action")
    }
    content = {"codebase_version": "v2.1", "fps": 200, "total_episodes": 1, "features": features}
    for part in ("meta", "data/chunk-000"):
        (folder / "set" / part).mkdir(parents=True)
    (folder / "set" / "meta" / "info.json").write_text(json.dumps(content))
    columns = {
        "observation.state": list(np.column_stack([data[f"q_{a}"] for a in AXES])),
        "action": list(np.column_stack([data[f"ref_{a}"] for a in AXES])),
        "timestamp": data["t"],
        "episode_index": np.zeros(ROWS, int),
    }
    pq.write_table(pa.table(columns), folder / "set" / "data" / "chunk-000" / "episode_000000.parquet")
