"""Small valid files of every kind that is read."""

from __future__ import annotations

import gzip
import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomli_w
from scipy.io import savemat

from workbench.core.paths import models_folder

AXES = "hip", "knee"
ROWS, PERIOD_S = 240, 0.005
_START_NS = 1_750_000_000 * 10**9


def table() -> dict[str, np.ndarray]:
    """Two driven axes that move as no sine does, their derivatives right."""
    t = np.arange(ROWS) * PERIOD_S
    out = {"t": np.round(t, 9)}
    for i, axis in enumerate(AXES):
        a, b = 12.0 + i, 31.0 + 3.0 * i
        q = 0.3 * np.sin(a * t) + 0.1 * np.sin(b * t + i)
        out[f"q_{axis}"] = q
        out[f"w_{axis}"] = 0.3 * a * np.cos(a * t) + 0.1 * b * np.cos(b * t + i)
        out[f"tau_{axis}"] = 2.0 * np.sin(a * t + 0.3)
        out[f"cmd_{axis}"] = 2.1 * np.sin(a * t + 0.25)
        out[f"ref_{axis}"] = 0.31 * np.sin(a * t + 0.1)
    return out


def description(file: str) -> dict[str, Any]:
    """The TOML of `table` in a file."""
    columns = {
        "position": "q", "velocity": "w", "torque_measured": "tau", "torque_command": "cmd",
        "position_reference": "ref",
    }  # fmt: skip
    return {
        "format": 1,
        "name": "run",
        "table": file,
        "rig": "leg",
        "coordinates": "actuator",
        "axes": list(AXES),
        "columns": {
            "time": "t",
            **{signal: [f"{short}_{axis}" for axis in AXES] for signal, short in columns.items()},
        },
        "units": {"time": "s", "position": "rad", "velocity": "rad/s", "torque": "N*m"},
        "controller": {
            "kind": "pd", "coordinates": "joint", "kp": [50.0, 50.0], "kd": [1.5, 1.5], "period_s": 0.005,
        },
        "excitation": {
            "kind": "multisine", "mode": "sum", "period_s": 0.6, "f_min_hz": 1.0, "f_max_hz": 40.0,
        },
        "timing": {"feedforward_held": True, "initial_at_rest": False, "delay": "motor"},
    }  # fmt: skip


def csv(columns: Mapping[str, Any], separator: str = ",") -> bytes:
    """Columns as text; they may be of different lengths."""
    length = max((len(v) for v in columns.values()), default=0)
    rows = [[_cell(v[k]) if k < len(v) else "" for v in columns.values()] for k in range(length)]
    return "\n".join(separator.join(row) for row in [list(columns), *rows]).encode("utf-8", "replace") + b"\n"


def _cell(value: Any) -> str:
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)


def write_table(path: Path, columns: Mapping[str, Any]) -> None:
    """Columns in the format that a file's name says; may raise whatever its writer does."""
    name = path.name
    if name.endswith(".csv.gz"):
        path.write_bytes(gzip.compress(csv(columns), 1, mtime=0))
    elif name.endswith((".csv", ".txt", ".tsv")):
        path.write_bytes(csv(columns, {".csv": ",", ".txt": " ", ".tsv": "\t"}[path.suffix]))
    elif name.endswith(".parquet"):
        pq.write_table(pa.table({n: pa.array(list(v)) for n, v in columns.items()}), path)
    elif name.endswith(".mat"):
        savemat(path, dict(columns))
    elif name.endswith(".npz"):
        np.savez(path, **{n: v for n, v in columns.items() if v.dtype != object})
    else:
        array = np.stack([np.asarray(v, float) for v in columns.values()], axis=1)
        np.save(path, array)


def recording(folder: Path, file: str = "run.csv") -> None:
    """``run.toml`` and its table."""
    write_table(folder / file, table())
    (folder / "run.toml").write_text(tomli_w.dumps(description(file)))


def model(folder: Path) -> None:
    """The reference leg with effects of several forms in it, its files beside it."""
    shipped = models_folder()
    text = (shipped / "leg.toml").read_text().replace("serial/", "").replace("closed_chain/", "")
    effects = [
        ("viscous_damping", "hip", {"damping": 0.05}),
        ("coulomb_friction", "knee", {"torque": {"value": 0.2, "std": 0.01, "unit": "N*m"}}),
        ("cogging", "hip", {"torque": 0.05, "order": 12.0, "phase": 0.3}),
    ]
    text += tomli_w.dumps(
        {
            "effects": [
                {"effect": e, "axis": a, "location": "actuator", "parameters": p} for e, a, p in effects
            ]
        }
    )
    (folder / "leg.toml").write_text(text)
    shutil.copy(shipped / "serial" / "leg.xml", folder)
    shutil.copy(shipped / "closed_chain" / "leg.sdf", folder)


def urdf(folder: Path) -> None:
    """A leg of two links, one of them closing a loop, as URDF."""
    link = (
        '<link name="{0}"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" '
        'izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    joint = (
        '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 {3}"/>'
        '<axis xyz="0 -1 0"/><limit lower="-1.5" upper="2.5" effort="9" velocity="9"/></joint>'
    )
    parts = [link.format(name) for name in ("thigh", "shank")]
    parts += [joint.format("hip", "world", "thigh", 0), joint.format("knee", "thigh", "shank", -0.2)]
    (folder / "leg.urdf").write_text(f'<robot name="leg"><link name="world"/>{"".join(parts)}</robot>')


def can_config(folder: Path) -> None:
    """Two drives on a bus between processes."""
    motors = [
        {
            "axis": axis, "bus": "can0", "protocol": "damiao", "id": i + 1, "reply_id": 17 + i,
            "ranges": {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "of the virtual drives"},
            "limits": {"position": [-3.0, 3.0], "velocity": 40.0, "torque": 20.0},
        }
        for i, axis in enumerate(AXES)
    ]  # fmt: skip
    content = {
        "format": 1, "name": "leg", "machine": "0123456789abcdef",
        "bus": [{"name": "can0", "interface": "workbench", "channel": "can0.sock"}], "motor": motors,
        "mechanism": [{"model": "leg", "axes": list(AXES)}],
        "loop": {"period_s": 0.003, "kp": [50.0, 50.0], "kd": [1.5, 1.5], "pd": "host"},
        "imu": {"bus": "can0", "id": 0x60},
        "bench": {"rig": "legs"},
    }  # fmt: skip
    (folder / "robot.toml").write_text(tomli_w.dumps(content))


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


def _states() -> Any:
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


def design(folder: Path) -> None:
    """A multisine for two axes."""
    from workbench.frf import Design, save_design
    from workbench.frf.excitation import Trial

    t = np.arange(200) * 0.001
    signals = np.stack(
        [np.column_stack([np.sin(2 * np.pi * 5 * t), s * np.sin(2 * np.pi * 5 * t)]) for s in (1, -1)]
    )
    trials = Trial("sum", "sum"), Trial("difference", "difference")
    made = Design(
        "d", "multisine", AXES, "torque_feedforward", 1000.0, signals, np.array([1]), trials, periods=1
    )
    save_design(made, folder / "design.toml")


def run(folder: Path) -> None:
    """The folder of a training run, its bundle, and a verification record, without having trained."""
    import torch

    from workbench.effects import load_model
    from workbench.training.checkpoint import save
    from workbench.training.export import export
    from workbench.training.learn import CHECKPOINT, CONFIG, MJCF, MODEL, _copy_model
    from workbench.training.machine import make_machine
    from workbench.training.settings import Settings, resolved
    from workbench.training.tasks import TASKS

    leg = load_model("leg")
    machine = make_machine("leg", leg, "s3n_full")
    config = resolved(TASKS["reach"], machine, Settings(), {"processes": 1, "record": None, "unverified": []})
    size = sum(entry["size"] for entry in config["observations"])
    torch.manual_seed(0)
    shapes = ((8, size), (8,)), ((2, 8), (2,))
    state = {"obs_normalizer._mean": torch.zeros(1, size), "obs_normalizer._std": torch.ones(1, size)}
    for i, (weight, bias) in zip((0, 2), shapes, strict=True):
        state |= {f"mlp.{i}.weight": 0.1 * torch.randn(weight), f"mlp.{i}.bias": torch.zeros(bias)}
    own = folder / "run"
    (own / MODEL).mkdir(parents=True)
    (own / CONFIG).write_text(json.dumps(config))
    (own / MJCF).write_text(machine.xml)
    _copy_model(machine.model, own / MODEL)
    save(own / CHECKPOINT, {"iteration": 2, "seconds": 1.0, "learner": {"actor_state_dict": state}})
    export(own, folder / "reach.zip")
    record = {
        "format": 1, "model": "leg", "variant": "exact", "files": leg.digests(),
        "checks": [{"name": "mass matrix", "passed": True}], "passed": True,
        "recordings": [{"name": "run", "error": 0.1, "noise_error": 0.1, "sha256": None}],
        "error": 0.1, "noise_error": 0.1, "consistent": True, "versions": {},
    }  # fmt: skip
    (folder / "leg.record.json").write_text(json.dumps(record))


def played(folder: Path) -> None:
    """A log that a loop left behind, with the note of when it began, its configuration and its design."""
    can_config(folder)
    design(folder)
    from workbench.can import Feedback, load_config, make_drive
    from workbench.can.candump import line
    from workbench.can.messages import Setpoint
    from workbench.deployment import joints_of
    from workbench.deployment.player import Player
    from workbench.frf import load_design

    config = load_config(folder / "robot.toml")
    joints, (kp, kd) = joints_of(config), (np.array(gains) for gains in config.gains())
    player = Player(load_design(folder / "design.toml"), 0, 0.003)
    lines, torque = [], np.zeros(len(config.motor))
    for k in range(120):
        seen = np.zeros((2, len(config.motor)))
        for i, motor in enumerate(config.motor):
            drive, stamp = make_drive(motor), 1e9 + 0.003 * k + 3e-4 * i
            lines.append(line(stamp, "can0", drive.command(Setpoint(0.0, 0.0, 0.0, 0.0, torque[i]))))
            q = float(player.reference[0, i]) + 0.02 * float(np.sin(0.05 * k + i))
            answer = drive.answer(Feedback(q, 0.0, 0.0, 30.0, True))
            lines.append(line(stamp + 2e-4, "can0", answer))
            said = drive.decode(answer)
            assert isinstance(said, Feedback)
            seen[:, i] = said.position, said.velocity
        # the loop's own law, on what was heard: it goes out with the next tick
        row = max(k - 1, 0)
        position, velocity = (joints.position(x) for x in seen)
        asked = joints.torque(kp * (joints.within(player.reference[row]) - position) - kd * velocity)
        torque = asked + player.feedforward[row] * (k > 0)
    (folder / "sum.log").write_text("".join(lines))
    (folder / "sum.begun").write_text(f"{1e9 + 0.003:.6f}\n")
