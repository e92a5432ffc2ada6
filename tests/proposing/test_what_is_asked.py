"""What an import asks, and what numbers, names and the model tell without a question."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.data_helpers import data_folder
from tests.proposing.make import KD, KP, columns, imported, log, same, text
from workbench.proposing import Answers, open_table, propose

LOG = log()


def put(folder: Path, data: dict) -> Path:
    path = folder / "run.csv"
    path.write_text(text(data))
    return path


@pytest.mark.parametrize(
    ("turn", "low", "high", "whole"),
    [(8192, -1.3, 8156.3, False), (16384, 0, 16383, True), (4096, 0, 4095, True), (1024, 3, 1023, True),
     (16384, -8192, 8190, True), (4000, 0, 3999, True)],
)  # fmt: skip
def test_counts_are_offered_with_their_turn(
    tmp_path: Path, turn: int, low: float, high: float, whole: bool
) -> None:
    span = (LOG.q[:, 0] - LOG.q[:, 0].min()) / np.ptp(LOG.q[:, 0])
    counts = low + (high - low) * span
    data = {"t": LOG.t, "pos": np.round(counts) if whole else counts, "torque": LOG.tau[:, 0]}
    table = open_table(put(tmp_path, data))
    asked = propose(table).questions
    assert [q.key for q in asked] == ["counts"] and asked[0].best == str(turn)
    assert f"--counts {turn}" in asked[0].option
    guessed = propose(table, Answers(counts=turn, guessed=frozenset({"counts"})))
    assert next(a.word for a in guessed.assumptions if a.what == "unit of position") == "a guess"
    _, recording = imported(table.file, Answers(counts=turn))
    assert np.ptp(recording.position) == pytest.approx(2 * np.pi * (high - low) / turn, rel=1e-3)


@pytest.mark.parametrize("top", [300.0, 2000.0, 7000.0])
def test_an_angle_that_fills_no_turn_is_no_count(tmp_path: Path, top: float) -> None:
    data = {"t": LOG.t, "pos": top * LOG.q[:, 0] / np.abs(LOG.q[:, 0]).max()}
    assert all(q.key != "counts" for q in propose(open_table(put(tmp_path, data))).questions)


def test_the_only_axis_of_a_model_is_not_asked_for(tmp_path: Path) -> None:
    data = {"t": LOG.t, "pos_estimate": LOG.q[:, 0], "vel_estimate": LOG.v[:, 0]}
    _, recording = imported(put(tmp_path, data), Answers(model_axes=("wheel",)))
    assert recording.axes == ("wheel",)


def test_a_torque_is_no_command_because_the_drives_were_off(tmp_path: Path) -> None:
    off = LOG.t > 2.5  # more than half of the log
    data = {"t": LOG.t}
    for i, joint in enumerate(("hip", "knee")):
        data |= {f"pos_{joint}": LOG.q[:, i], f"vel_{joint}": LOG.v[:, i]}
        data[f"torque_{joint}"] = np.where(off, 0.0, LOG.tau[:, i])
    _, recording = imported(put(tmp_path, data))
    assert recording.get("torque_command") is None and recording.get("torque_measured") is not None


@pytest.mark.parametrize("law", [True, False])
def test_efforts_of_joints_without_a_drive_say_nothing(tmp_path: Path, law: bool) -> None:
    data = {"t": LOG.t}
    for i, joint in enumerate(("hip", "knee")):
        torque = KP[i] * (LOG.ref[:, i] - LOG.q[:, i]) - KD[i] * LOG.v[:, i] if law else LOG.tau[:, i]
        own = {"position": LOG.q[:, i], "velocity": LOG.v[:, i], "effort": torque}
        own |= {"position_ref": LOG.ref[:, i]}
        rod = {"position": -LOG.q[:, i], "velocity": -LOG.v[:, i], "effort": np.zeros(len(LOG.t))}
        data |= {f"{joint}.{kind}": v for kind, v in own.items()}
        data |= {f"rod_{joint}.{kind}": v for kind, v in rod.items()}
    _, recording = imported(put(tmp_path, data), Answers(model_axes=("hip", "knee")))
    assert (recording.get("torque_command") is not None) == law
    assert (recording.get("torque_measured") is not None) != law


def test_one_joint_may_be_called_motor(tmp_path: Path) -> None:
    data = {name.replace("knee", "motor"): values for name, values in columns(LOG).items()}
    _, recording = imported(put(tmp_path, data))
    same(recording, LOG, tolerance=1e-9)
    assert recording.axes == ("hip", "motor")


def test_no_unit_in_the_row_of_units_is_none(tmp_path: Path) -> None:
    data = {"t": LOG.t}
    for i in (1, 2):
        data |= {f"pos_{i}": LOG.q[:, i - 1], f"vel_{i}": LOG.v[:, i - 1], f"gain_{i}": LOG.t + i}
    lines = text(data).split("\n")
    units = ["s", *["rad", "rad/s", "1"] * 2]
    path = tmp_path / "run.csv"
    path.write_text("\n".join([lines[0], ",".join(units), *lines[1:]]))
    table = open_table(path)
    assert "gain_1" not in table.units and table.units["pos_1"] == "rad"
    assert imported(path)[1].axes == ("joint1", "joint2")


@pytest.mark.parametrize("name", ["valid", "good"])
def test_rows_that_the_log_says_are_not_measured_are_masked(tmp_path: Path, name: str) -> None:
    data = columns(LOG) | {name: ((LOG.t < 2) | (LOG.t > 2.2)).astype(int)}
    answers = Answers(columns={"valid": (name,)} if name != "valid" else {})
    proposal, recording = imported(put(tmp_path, data), answers)
    assert np.array_equal(recording.valid, data[name] == 1)
    assert not any("Not used" in note for note in proposal.notes)


@pytest.mark.parametrize(("size", "best"), [(4096, "4096"), (16384, "16384"), (65536, "")])
def test_counts_that_wrap_are_offered_with_their_turn(size: int, best: str, tmp_path: Path) -> None:
    t = 0.002 * np.arange(4000)
    counts = np.round((6 + 3 * np.sin(2 * t)) / (2 * np.pi) * size) % size
    table = open_table(put(tmp_path, {"t": t, "pos": counts, "torque": np.cos(2 * t)}))
    asked = {q.key: q.best for q in propose(table).questions}
    assert asked["counts"] == best


def test_counts_of_a_measured_motor(tmp_path: Path) -> None:
    file = data_folder("odrive") / "nocomp_0.csv.gz"
    asked = propose(open_table(file), Answers(model_axes=("motor",), linear=(False,))).questions
    assert [(q.key, q.best) for q in asked] == [("counts", "8192")]
    copy = tmp_path / file.name
    copy.write_bytes(file.read_bytes())
    _, recording = imported(copy, Answers(model_axes=("motor",), linear=(False,), counts=8192))
    assert 0.99 < np.ptp(recording.position) / (2 * np.pi) < 1.0


def test_a_sensor_that_stops_is_no_slower_log(tmp_path: Path) -> None:
    data = dict(columns(LOG))
    name = "pos_hip"
    data[name] = np.where(np.arange(len(data[name])) < len(data[name]) // 2, data[name], np.nan)
    notes = propose(open_table(put(tmp_path, data))).notes
    assert not any("more slowly" in note for note in notes)
    assert any("before and after the measurement" in note for note in notes)
