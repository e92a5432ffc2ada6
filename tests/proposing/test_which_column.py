"""Which column is what, and of which axis, as names and numbers tell it together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KD, KP, columns, imported, log, put, same, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose
from workbench.proposing.names import role_of

LOG = log()
DEG = np.pi / 180


def test_velocity_missing_is_derived(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if not k.startswith("vel")}
    _, recording = imported(put(tmp_path, text(data)))
    assert recording.derived == ("velocity",)
    assert np.abs(recording.velocity - LOG.v)[5:-5].std() < 0.02 * LOG.v.std()


def test_velocity_counted_the_other_way(tmp_path: Path) -> None:
    data = columns(LOG)
    data["vel_knee"] = -data["vel_knee"]
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert any("knee" in note and "sign" in note for note in proposal.notes)


def test_two_velocities_swapped_where_references_tell(tmp_path: Path) -> None:
    data = columns(LOG)
    data["vel_hip"], data["vel_knee"] = data["vel_knee"], data["vel_hip"]
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert any("swapped" in note for note in proposal.notes)


def test_two_columns_swapped_where_nothing_tells_is_a_question(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if "ref" not in k and "cmd" not in k}
    data["vel_hip"], data["vel_knee"] = data["vel_knee"], data["vel_hip"]
    proposal = propose(open_table(put(tmp_path, text(data))))
    assert [q.key for q in proposal.questions] == ["column.velocity"] and not proposal.questions[0].best


def test_command_and_measured_told_by_who_leads(tmp_path: Path) -> None:
    lag, data = 4, {"time": LOG.t}
    for i, joint in enumerate(("hip", "knee")):
        data |= {
            f"{joint} angle": np.roll(LOG.q[:, i], -lag),
            f"{joint} pos": LOG.q[:, i],
            f"{joint} speed": LOG.v[:, i],
        }
    proposal = propose(open_table(put(tmp_path, text({k: v[:-lag] for k, v in data.items()}))))
    found = proposal.description["columns"]
    assert found["position"] == ["hip pos", "knee pos"]
    assert found["position_reference"] == ["hip angle", "knee angle"]


def test_qd_is_a_speed_or_a_reference_as_its_numbers_say(tmp_path: Path) -> None:
    both = {"t": LOG.t, **{f"q{i}": LOG.q[:, i] for i in (0, 1)}}
    speed = propose(open_table(put(tmp_path, text({**both, **{f"qd{i}": LOG.v[:, i] for i in (0, 1)}}))))
    wanted = propose(open_table(put(tmp_path, text({**both, **{f"qd{i}": LOG.ref[:, i] for i in (0, 1)}}))))
    assert speed.description["columns"]["velocity"] == ["qd0", "qd1"]
    assert wanted.description["columns"]["position_reference"] == ["qd0", "qd1"]
    assert "velocity" not in wanted.description["columns"]


def test_without_time_the_derivative_offers_the_rate(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if k != "t"}
    table = open_table(put(tmp_path, text(data)))
    asked = propose(table).questions
    assert [q.key for q in asked] == ["rate"] and float(asked[0].best) == pytest.approx(200, rel=0.03)
    same(imported(table.file, Answers(rate_hz=200.0))[1], LOG, tolerance=1e-9)


def test_a_torque_that_is_the_law_itself_is_the_command(tmp_path: Path) -> None:
    data = columns(LOG)
    for joint, i in (("hip", 0), ("knee", 1)):
        for name in [n for n in data if ("torque" in n and joint in n) or n == f"cmd_{joint}"]:
            del data[name]
        data[f"torque_{joint}"] = KP[i] * (LOG.ref[:, i] - LOG.q[:, i]) - KD[i] * LOG.v[:, i]
    proposal, recording = imported(put(tmp_path, text(data)))
    assert "torque_command" in recording.signals and "torque_measured" not in recording.signals
    assert recording.controller.kind == "pd" and not proposal.questions
    noisy = data | {n: v + 0.05 * np.ptp(v) * np.cos(9.0 * LOG.t) for n, v in data.items() if "torque" in n}
    assert "torque_measured" in imported(put(tmp_path, text(noisy)))[1].signals


def test_encoder_counts_are_asked_for(tmp_path: Path) -> None:
    data = columns(LOG)
    for joint, i in (("hip", 0), ("knee", 1)):
        data[f"pos_{joint}"] = np.round(LOG.q[:, i] / (2 * np.pi) * 65536)
        data[f"pos_ref_{joint}"] = LOG.ref[:, i] / (2 * np.pi) * 65536
    table = open_table(put(tmp_path, text(data)))
    assert [q.key for q in propose(table).questions] == ["counts"]
    proposal, recording = imported(table.file, Answers(counts=65536))
    same(recording, LOG)
    assert not any("wrong unit" in note for note in proposal.notes)


@pytest.mark.parametrize("name", ["rpm", "speed"])
def test_beside_encoder_counts_the_speed_tells_its_own_unit(tmp_path: Path, name: str) -> None:
    data = columns(LOG, v=2 * np.pi / 60)
    for joint, i in (("hip", 0), ("knee", 1)):
        data[f"pos_{joint}"] = np.round(LOG.q[:, i] / (2 * np.pi) * 65536)
        data[f"pos_ref_{joint}"] = LOG.ref[:, i] / (2 * np.pi) * 65536
        data[f"{name}_{joint}"] = data.pop(f"vel_{joint}")
    table = open_table(put(tmp_path, text(data)))
    proposal = propose(table, Answers(counts=65536))
    assert not proposal.questions and proposal.description["units"]["velocity"] == "rpm"
    assert not any("wrong unit" in note for note in proposal.notes)


def test_the_models_axes_by_name_and_by_order(tmp_path: Path) -> None:
    file = put(tmp_path, text(columns(LOG)))
    table = open_table(file)
    by_name = propose(table, Answers(model_axes=("knee_pitch", "hip_pitch")))
    assert by_name.description["columns"]["position"] == ["pos_knee", "pos_hip"] and not by_name.questions
    by_order = propose(table, Answers(model_axes=("first", "second")))
    assert [q.key for q in by_order.questions] == ["axes"] and "hip is first" in by_order.questions[0].text


def test_the_axis_without_a_position_is_named(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if k != "pos_knee"}
    with pytest.raises(InputError, match="has no position of knee_pitch") as caught:
        propose(open_table(put(tmp_path, text(data))), Answers(model_axes=("knee_pitch", "hip_pitch")))
    assert "--column 'position=NAME,pos_hip'" in str(caught.value.remedy)


def test_a_law_in_the_joints_is_found_behind_a_transmission(tmp_path: Path) -> None:
    belt = np.array([[1.0, 0.0], [1.0, 1.0]])
    data = {"t": LOG.t}
    command = LOG.cmd @ np.linalg.inv(belt)  # torques go the other way than motion
    for i, name in enumerate(("hip", "knee")):
        data |= {f"q_{name}": (LOG.q @ belt.T)[:, i], f"w_{name}": (LOG.v @ belt.T)[:, i]}
        data |= {f"qref_{name}": LOG.ref[:, i], f"cmd_{name}": command[:, i]}
    file = put(tmp_path, text(data))
    asked = propose(open_table(file), Answers(transmission=belt)).questions
    assert [q.key for q in asked] == ["coordinates"]
    _, recording = imported(file, Answers(transmission=belt, coordinates="actuator"))
    assert recording.controller.coordinates == "joint"
    assert np.allclose(recording.controller.kp, KP, rtol=0.01)


@pytest.mark.parametrize("joints", [("hip", "foot"), ("rod", "link")])
def test_joints_that_are_called_like_units_of_length_are_joints(
    tmp_path: Path, joints: tuple[str, str]
) -> None:
    data = {
        name.replace("hip", "#").replace("knee", joints[1]).replace("#", joints[0]): values
        for name, values in columns(LOG).items()
    }
    recording = imported(put(tmp_path, text(data)))[1]
    same(recording, LOG, tolerance=1e-9)
    assert recording.axes == joints


def test_a_column_that_numbers_rows_is_not_in_newtons() -> None:
    assert (role_of("n").kind, role_of("n").unit) == ("index", "")
