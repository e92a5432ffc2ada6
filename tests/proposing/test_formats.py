"""Logs and data sets of other people become the recording that they hold."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import can
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fuzzing.seeds import JOINT_STATE
from scipy.io import savemat

from tests.data_helpers import data_folder
from tests.proposing.make import columns, imported, log, same
from workbench.can import Damiao, Feedback, Ranges, dbc
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose

LOG = log(600)
NAMES = ["hip", "knee"]
NOW = 1_750_000_000


def test_parquet(tmp_path: Path) -> None:
    pq.write_table(pa.table(columns(LOG)), tmp_path / "run.parquet")
    proposal, recording = imported(tmp_path / "run.parquet")
    same(recording, LOG, tolerance=1e-9)
    assert proposal.data is None


def test_parquet_with_lists(tmp_path: Path) -> None:
    table = {
        "timestamp": LOG.t,
        "q": list(LOG.q),
        "dq": list(LOG.v),
        "tau": list(LOG.tau),
        "note": ["a"] * 600,
    }
    pq.write_table(pa.table(table), tmp_path / "run.parquet")
    same(imported(tmp_path / "run.parquet")[1], LOG, tolerance=1e-9)


def test_matlab_with_a_struct(tmp_path: Path) -> None:
    inner = {"time": LOG.t[:, None], "q": LOG.q, "qd": LOG.v, "tau": LOG.tau, "name": "bench"}
    savemat(tmp_path / "run.mat", {"data": inner, "gain": 3.0})
    proposal, recording = imported(tmp_path / "run.mat")
    same(recording, LOG, tolerance=1e-9)
    assert proposal.data is None


def test_numpy(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "run.npz", t=LOG.t, pos=LOG.q, vel=LOG.v, torque=LOG.tau.T)
    same(imported(tmp_path / "run.npz")[1], LOG, tolerance=1e-9)


def _stamp(t: float) -> int:
    return NOW * 10**9 + round(t * 1e9)


def test_ros_2_bag(tmp_path: Path) -> None:
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kind: Any = store.types
    state, array = kind["sensor_msgs/msg/JointState"], kind["std_msgs/msg/Float64MultiArray"]
    header, time = kind["std_msgs/msg/Header"], kind["builtin_interfaces/msg/Time"]
    layout = kind["std_msgs/msg/MultiArrayLayout"]
    with Writer(tmp_path / "bag", version=9) as bag:
        states = bag.add_connection("/joint_states", state.__msgtype__, typestore=store)
        asked = bag.add_connection("/leg_controller/commands", array.__msgtype__, typestore=store)
        for k, t in enumerate(LOG.t):
            ns = _stamp(t)
            seen = [x[k, ::-1].copy() for x in (LOG.q, LOG.v, LOG.tau)]
            message = state(header(time(ns // 10**9, ns % 10**9), ""), NAMES[::-1], *seen)
            bag.write(states, ns + 200_000, store.serialize_cdr(message, state.__msgtype__))
            if k % 2 == 0:
                wanted = array(layout([], 0), LOG.ref[k, ::-1].copy())
                bag.write(asked, ns - 100_000, store.serialize_cdr(wanted, array.__msgtype__))
    proposal, recording = imported(tmp_path / "bag", Answers(model_axes=("hip", "knee")))
    same(recording, LOG, tolerance=1e-6)
    reference = recording.get("position_reference")
    assert reference is not None and np.abs(reference[::2] - LOG.ref[::2]).max() < 1e-9
    assert proposal.data is not None
    with pytest.raises(InputError, match="part of a ROS 2 bag"):
        open_table(tmp_path / "bag" / "metadata.yaml")


def test_mcap_of_ros_2(tmp_path: Path) -> None:
    writer_of = pytest.importorskip("mcap_ros2.writer")
    with (tmp_path / "run.mcap").open("wb") as file:
        writer = writer_of.Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for k, t in enumerate(LOG.t):
            ns = _stamp(t)
            message = {
                "header": {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": ""},
                "name": NAMES,
                "position": LOG.q[k].tolist(),
                "velocity": LOG.v[k].tolist(),
                "effort": LOG.tau[k].tolist(),
            }
            writer.write_message("/joint_states", schema, message, log_time=ns, publish_time=ns)
        writer.finish()
    same(imported(tmp_path / "run.mcap")[1], LOG, tolerance=1e-6)


def test_mcap_of_json(tmp_path: Path) -> None:
    writer_of = pytest.importorskip("mcap.writer")
    with (tmp_path / "run.mcap").open("wb") as file:
        writer = writer_of.Writer(file)
        writer.start()
        schema = writer.register_schema("state", "jsonschema", b"{}")
        channel = writer.register_channel("/leg/state", "json", schema)
        for k, t in enumerate(LOG.t):
            message = {"q": LOG.q[k].tolist(), "dq": LOG.v[k].tolist(), "tau": LOG.tau[k].tolist()}
            writer.add_message(channel, _stamp(t), json.dumps(message).encode(), _stamp(t))
        writer.finish()
    same(imported(tmp_path / "run.mcap")[1], LOG, tolerance=1e-6)


def lerobot(folder: Path, **info: Any) -> Path:
    """A data set of two episodes."""
    (folder / "meta").mkdir(parents=True)
    (folder / "data" / "chunk-000").mkdir(parents=True)
    names = [f"{name}.pos" for name in NAMES]
    features = {
        n: {"dtype": "float32", "shape": [2], "names": names} for n in ("observation.state", "action")
    }
    content = {"codebase_version": "v2.1", "fps": 200, "total_episodes": 2, "features": features, **info}
    (folder / "meta" / "info.json").write_text(json.dumps(content))
    for episode in (0, 1):
        table = {
            "observation.state": list(np.degrees(LOG.q * (1 + episode)).astype("f4")),
            "action": list(np.degrees(LOG.ref * (1 + episode)).astype("f4")),
            "timestamp": LOG.t.astype("f4"),
            "episode_index": np.full(600, episode),
        }
        pq.write_table(pa.table(table), folder / "data" / "chunk-000" / f"episode_{episode:06d}.parquet")
    return folder


def test_lerobot(tmp_path: Path) -> None:
    folder = lerobot(tmp_path / "set", data_path="../../etc/{episode_chunk.__class__}")
    table = open_table(folder, episode=1)
    proposal = propose(table)
    assert proposal.description["axes"] == ["hip", "knee"]
    assert proposal.description["units"]["position"] == "deg"
    assert np.allclose(table.columns["observation.state/knee.pos"], np.degrees(2 * LOG.q[:, 1]), atol=1e-3)
    assert "position_reference" in proposal.description["columns"]
    with pytest.raises(InputError, match="no episode 7"):
        open_table(folder, episode=7)


def test_lerobot_is_read_by_a_process_with_nothing_else_loaded(tmp_path: Path) -> None:
    code = "import pathlib, sys, workbench.proposing as p; p.open_table(pathlib.Path(sys.argv[1]))"
    words = [sys.executable, "-c", code, str(lerobot(tmp_path / "set"))]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_can_log(tmp_path: Path) -> None:
    ranges = Ranges(12.5, 30.0, 10.0, 500.0, 5.0, "label")
    drives = {"hip": Damiao(1, 0x11, ranges), "knee": Damiao(2, 0x12, ranges)}
    with can.Logger(tmp_path / "run.blf") as log_file:
        for k, t in enumerate(LOG.t):
            for j, drive in enumerate(drives.values()):
                seen = Feedback(LOG.q[k, j], LOG.v[k, j], LOG.tau[k, j], 30.0, True)
                frame = drive.answer(seen)
                log_file(can.Message(1e9 + t + 1e-4 * j, frame.id, False, data=frame.data, channel=0))
    (tmp_path / "run.dbc").write_text(dbc(drives))
    proposal, recording = imported(tmp_path / "run.blf")
    assert recording.axes == ("hip", "knee")
    assert np.abs(recording.position - LOG.q)[5:-5].max() < 0.02
    assert proposal.description["columns"]["torque_measured"] == ["torque_hip", "torque_knee"]


def test_a_measured_drive(tmp_path: Path) -> None:
    """The EMPS drive moves along a line, as its model says."""
    table = open_table(data_folder("emps") / "DATA_EMPS.mat")
    proposal = propose(table, Answers(model_axes=("slide",), linear=(True,)))
    columns = proposal.description["columns"]
    assert columns["time"] == "t" and columns["position"] == ["qm"]
    assert columns["position_reference"] == ["qg"]
    assert proposal.description["units"]["position"] == "m"
